"""The lattice of a scene in the axes of an archive, and its tiles."""

from collections import namedtuple

import numpy as np

ROUNDING = 1e-6  # in steps: the program's tolerance at the bounds of the lattice

# own: the indices of the lattice's values of r1, r3 and r2 in the axes of the archive.
# rows: how many designs there are along r2, for each r3 of the archive.
Lattice = namedtuple("Lattice", "own rows")


def rounded(value):
    """A value rounded to 15 digits."""
    return float(f"{value:.15g}")


def arms(job):
    """The values of r1 strictly between the bounds (47) of a job's scene, m."""
    h0, h, r4 = (float(job.get(("scene", key), 0)) for key in (
        "fulcrum-height", "release-height", "counterweight-hanger"))
    low = 0 if ("scene", "start-angle") in job else max(0, h - h0 + r4)
    step = float(job["lattice", "increment"])
    count = int(np.ceil((h0 - r4 - low) / step - ROUNDING)) - 1
    return [rounded(rounded(low + step) + i * step) for i in range(count)]


def whole_lattice(job, axes):
    """The Lattice of an archive with one scene. Its axes are `axes`, {name: values in m}."""
    r1, r3, r2 = axes.values()
    if ("lattice", "r2") in job:
        rows = np.full(len(r3), len(r2))
    else:
        h0 = float(job["scene", "fulcrum-height"])
        rows = np.searchsorted(r2, h0 - r3 - ROUNDING * r2[0])  # r2 < h0 - r3 (49)
    return Lattice([np.arange(len(values)) for values in axes.values()], rows)


def lattice_in_box(job, box):
    """The Lattice of the scene of a job in axes that hold the values of other scenes as well."""
    r1, r3, r2 = box.values()
    own, rows = whole_lattice(job, box)
    if ("lattice", "r1") not in job:
        own[0] = np.flatnonzero(np.isin(r1, arms(job)))
    if ("lattice", "r3") not in job:
        h0 = float(job["scene", "fulcrum-height"])
        own[1] = np.flatnonzero(r3 < h0 - ROUNDING * float(job["lattice", "increment"]))
        rows[len(own[1]):] = 0
    if ("lattice", "r2") not in job:
        own[2] = np.arange(rows[0])
    return Lattice(own, rows)


def designs(lattice):
    """Whether there is a design at each of the lattice's values, an array (r1, r3, r2) of bool."""
    r1, r3, r2 = lattice.own
    plane = lattice.rows[r3, np.newaxis] > r2
    return np.broadcast_to(plane, (len(r1), *plane.shape))


def tiles_with_designs(lattice, shape, edge):
    """Whether each tile of an archive's box holds designs, as an array (r1, r3, r2) of bool.

    The program numbers the tiles that do, along r2, then r3, then r1.
    """
    planes = np.zeros(-(-shape[0] // edge[0]), bool)
    planes[lattice.own[0] // edge[0]] = True
    # Rows never become longer with r3, so a tile holds a design if its lowest corner does.
    corners = lattice.rows[::edge[1], np.newaxis] > np.arange(0, shape[2], edge[2])
    return planes[:, np.newaxis, np.newaxis] & corners
