"""Shared by the Python tests: what an archive holds, and its tiles."""

import os

import numpy as np

# A killed process may hold HDF5's own lock for a moment after it was reported dead.
os.environ["HDF5_USE_FILE_LOCKING"] = "FALSE"
import h5py  # pylint: disable=wrong-import-position

# Attributes that depend on the run or its command line.
ATTRIBUTES_OF_RUN = ("history", "title", "job", "lane_steps", "integration_seconds", "sweep_seconds")


def contents(archive):
    """{name: bytes or value} of everything in an archive that does not depend on the run: an attribute is named @name."""
    held = {name: data[...].tobytes() for name, data in archive.items()}
    for name, value in archive.attrs.items():
        if name not in ATTRIBUTES_OF_RUN:
            held[f"@{name}"] = np.asarray(value).tobytes() if not isinstance(value, str) else value
    return held


def differences(a, b):
    """The names of what differs between two archives, given by their paths."""
    with h5py.File(a) as first, h5py.File(b) as second:
        one, other = contents(first), contents(second)
    return sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))


def tiles(archive):
    """The slices in the maps of the tiles of all scenes."""
    outer = archive["scene_lattice"].shape
    for scene, *block in archive["tile_block"][...].astype(int).tolist():
        yield (*(slice(i, i + 1) for i in np.unravel_index(scene, outer)),
               *(slice(first, first + count) for first, count in zip(block[:3], block[3:])))


def tiles_done(archive):
    """Whether each tile is done."""
    return archive["tile_designs"][...].any(axis=1)
