"""The lattices of an archive's scenes."""

from collections import namedtuple

import numpy as np

# own: the indices of the lattice's values of r1, r3 and r2 in the axes of the archive.
# rows: how many designs there are along r2, the first ones, for each r3 of the archive.
Lattice = namedtuple("Lattice", "own rows")


def read_lattices(file):
    """The Lattices in an archive, an h5py.File."""
    return [Lattice([np.flatnonzero(r1), np.flatnonzero(rows), np.arange(rows.max())], rows)
            for r1, rows in zip(file["lattice_r1"][...],
                                file["lattice_rows"][...].astype(np.int64))]


def designs(lattice):
    """Whether there is a design at each of the lattice's values, an array (r1, r3, r2) of bool."""
    r1, r3, r2 = lattice.own
    plane = lattice.rows[r3, np.newaxis] > r2
    return np.broadcast_to(plane, (len(r1), *plane.shape))
