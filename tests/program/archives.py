"""Shared by the Python tests: what an archive holds, and its tiles."""

import os

import numpy as np

# A killed process may hold HDF5's own lock for a moment after it was reported dead.
os.environ["HDF5_USE_FILE_LOCKING"] = "FALSE"
import h5py  # pylint: disable=wrong-import-position

SECONDS = ("lane_steps", "integration_seconds", "sweep_seconds")  # columns of tile_tally that depend on the run
# Attributes that depend on the run or its command line.
ATTRIBUTES_OF_RUN = ("history", "title", "job", "lane_utilisation", "integration_seconds", "sweep_seconds")


def contents(archive):
    """{name: bytes or value} of everything in an archive that does not depend on the run: an attribute is named @name."""
    held = {name: data[...].tobytes() for name, data in archive.items()
            if name not in ("tile_tally", "tile_checksum")}
    columns = archive["tile_tally"].attrs["columns"].split()
    same = [i for i, column in enumerate(columns) if column not in SECONDS]
    held["tile_tally"] = archive["tile_tally"][...][:, same].tobytes()
    held["tile_checksum"] = archive["tile_checksum"][...][:, :-1].tobytes()  # the last column is that of tile_tally
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
    """The slices of the blocks of all scenes, in the order of tile_done, which has those that hold a design."""
    extent = archive["status"].shape
    edge = [1] * (len(extent) - 3) + [int(archive["tile_done"].attrs[f"edge_{axis}"]) for axis in ("r1", "r3", "r2")]
    for first in np.ndindex(*(-(-n // e) for n, e in zip(extent, edge))):
        yield tuple(slice(i * e, (i + 1) * e) for i, e in zip(first, edge))
