"""Reads archives into xarray: `xarray.open_dataset("study.h5", engine=trebsweep.backend.Archive)`.

Maps stay in the file until they are used. In the dataset, unlike in the file, the cells of tiles that are not done are
NaN (numbers) or 0 (flags), and what else the file tells by tile or by lattice stands at the scenes:

  lattice_r1 (outer axes..., r1), lattice_r3_r2 (outer axes..., r3, r2)
                               whether there are designs: one where both are true
  best_value, best_r1, ...     the optimum of each scene so far, NaN where it has none
  tiles, tiles_done, released  the numbers of tiles, of those that are done, and of designs with a release

So a dataset is whole in itself: one that xarray.concat or merge has made of several, saved with to_netcdf, is read
again as an archive.
"""

import contextlib
import importlib
import os

import h5py
import numpy as np
import xarray
from xarray.backends import BackendArray, BackendEntrypoint
from xarray.core import indexing

from .program import Error, fail

AXES = ("r1", "r3", "r2")
OPTIMUM = ("value", "speed", *AXES, "release_time", "error")  # best_...: datasets or root attributes
HIDDEN = {"CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "_FillValue", "_Netcdf4Dimid", "_Netcdf4Coordinates",
          "_NCProperties", "coordinates", "columns"}  # attributes that describe the file


@contextlib.contextmanager
def reading(path, what="is damaged"):
    """Reports whatever HDF5, or a file with unexpected contents, raises as an Error."""
    try:
        yield
    except Error:
        raise
    except Exception as error:  # pylint: disable=broad-except  # h5py raises almost any
        raise Error(f"{path}: {what}: {error}") from error


def open_file(path):
    """Opens the HDF5 file at `path` for reading."""
    if not os.path.isfile(path):
        fail(f"{path}: {'is a directory, not a file' if os.path.isdir(path) else 'no such file'}")
    with reading(path, "cannot be opened as an HDF5 file"):
        return h5py.File(path, "r")


class Map(BackendArray):
    """A map of an archive, whose cells in `blank` slices are not done."""

    def __init__(self, data, blank):
        self.data, self.blank, self.shape = data, blank, data.shape
        self.flags = "flag_meanings" in data.attrs
        self.dtype = np.dtype("u1") if self.flags else data.dtype

    def __getitem__(self, key):
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.BASIC, self.read)

    def read(self, key):
        """The values at a tuple of integers and slices."""
        with reading(self.data.file.filename, f"cannot read map {self.data.name.strip('/')}"):
            values = self.data[key]
            if values.dtype.kind == "f" and self.flags:  # of a merge
                values = np.nan_to_num(values).astype(self.dtype)
            chosen = [np.atleast_1d(np.arange(n)[k]) for n, k in zip(self.shape, key)]
            cells = np.reshape(values, [len(c) for c in chosen])
            for block in self.blank:
                first, last = zip(*((np.searchsorted(c, b.start), np.searchsorted(c, b.stop))
                                    for c, b in zip(chosen, block)))
                cells[tuple(map(slice, first, last))] = 0 if self.flags else np.nan
            return cells.reshape(np.shape(values))


def attributes(item):
    """The attributes of a dataset or a file."""
    return {name: value.decode() if isinstance(value, bytes) else value
            for name, value in item.attrs.items() if name not in HIDDEN and not isinstance(value, h5py.Empty)}


def dimensions(data):
    """The names of a dataset's dimensions."""
    name = os.path.basename(data.name)
    if h5py.h5ds.is_scale(data.id):
        return (name,) * data.ndim
    return tuple(os.path.basename(scale[0].name) if len(scale) else f"{name}_{i}" for i, scale in enumerate(data.dims))


class Layout:
    """The axes and the tiles of a file."""

    def __init__(self, file):
        self.file, self.path = file, file.filename
        missing = [name for name in AXES if name not in file]
        if missing:
            fail(f"{self.path}: is not an archive of trebsweep: it has no {missing[0]}")
        self.maps = [name for name, data in file.items() if isinstance(data, h5py.Dataset) and
                     set(AXES) <= set(dimensions(data))]
        best = [dimensions(file[name]) for name in ("best_value", "scene_lattice") if name in file]
        outer = [name for dims in [*map(dimensions, map(file.get, self.maps)), *best] for name in dims]
        self.outer = tuple(name for name in dict.fromkeys(outer) if name not in AXES)
        self.axes = {name: self.axis(name) for name in (*self.outer, *AXES)}
        self.shape = tuple(len(self.axes[name]) for name in self.outer)
        self.has_tiles = "tile_block" in file and file["tile_block"].ndim == 2

    def axis(self, name):
        """The values of an axis."""
        values = self.file[name][...]
        if values.ndim != 1 or not values.size or not np.isfinite(values).all() or (np.diff(values) <= 0).any():
            raise ValueError(f"{name} is not an axis of increasing values")
        return values

    def tiles(self):
        """The variables that count tiles, and {whether tile is done}, blocks of slices of those that are not."""
        blocks = self.file["tile_block"][...].astype(np.int64)
        counts, columns = self.file["tile_designs"], str(self.file["tile_designs"].attrs["columns"]).split()
        counts = counts[...].astype(np.int64)
        done, scene = counts.any(axis=1), blocks[:, 0]
        box = tuple(len(self.axes[name]) for name in AXES)
        if len(done) != len(blocks) or (blocks < 0).any() or (blocks[:, 4:] < 1).any() or (
                scene >= np.prod(self.shape, dtype=int)).any() or (blocks[:, 1:4] + blocks[:, 4:] > box).any():
            raise ValueError("tile_block has invalid tiles")
        released = sum(counts[:, columns.index(name)] for name in ("released", "released_below_ground"))

        def per_scene(numbers):
            sums = np.zeros(self.shape, np.int64)
            np.add.at(sums.reshape(-1), scene, numbers)
            return self.outer, sums

        blank = [(*(slice(i, i + 1) for i in np.unravel_index(number, self.shape)),
                  *(slice(a, a + n) for a, n in zip(first, count)))
                 for number, first, count in zip(scene[~done], blocks[~done, 1:4], blocks[~done, 4:])]
        return {"tiles": per_scene(1), "tiles_done": per_scene(done), "released": per_scene(released)}, blank

    def lattices(self):
        """The variables that tell where the scenes have designs."""
        number = self.file["scene_lattice"][...].astype(np.int64)
        rows = self.file["lattice_rows"][...].astype(np.int64)[number]
        if number.shape != self.shape:
            raise ValueError("scene_lattice does not have the shape of the scenes")
        return {"lattice_r1": ((*self.outer, "r1"), self.file["lattice_r1"][...][number] != 0),
                "lattice_r3_r2": ((*self.outer, "r3", "r2"), rows[..., np.newaxis] > np.arange(len(self.axes["r2"])))}

    def optima(self):
        """The variables best_...: from datasets, else from root attributes."""
        for name in OPTIMUM:
            data, root = self.file.get(f"best_{name}"), self.file.attrs
            if data is not None and dimensions(data) == self.outer:
                yield f"best_{name}", (self.outer, data[...], attributes(data))
            elif not self.outer and f"best_{name}" in root:
                yield f"best_{name}", ((), float(root[f"best_{name}"]))


class Archive(BackendEntrypoint):
    """The backend of xarray for archives of trebsweep, and for files that xarray has made of them."""

    def open_dataset(self, filename_or_obj, *, drop_variables=None):  # pylint: disable=arguments-differ
        importlib.import_module(".accessor", __package__)  # registers Dataset.treb
        file = open_file(os.fspath(filename_or_obj))
        with reading(file.filename):
            dataset = read(file).drop_vars(drop_variables or [], errors="ignore")
        dataset.set_close(file.close)
        return dataset


def read(file):
    """The dataset of an open file."""
    layout = Layout(file)
    counts, blank = layout.tiles() if layout.has_tiles else ({}, [])
    kept = {name: (dimensions(file[name]), file[name][...]) for name in (
        "tiles", "tiles_done", "released", "lattice_r1", "lattice_r3_r2") if name in file and "lattice_r3_r2" in file}
    variables = {**kept, **counts, **(layout.lattices() if layout.has_tiles else {}), **dict(layout.optima())}
    for name in layout.maps:
        data = file[name]
        if data.shape != tuple(len(layout.axes[axis]) for axis in dimensions(data)):
            raise ValueError(f"{name} does not have the shape of the lattice")
        lazy = indexing.LazilyIndexedArray(Map(data, blank))
        variables.setdefault(name, xarray.Variable(dimensions(data), lazy, attributes(data)))
    if layout.has_tiles and not layout.maps and "maps = none" not in str(file.attrs["job"]):
        raise ValueError("it has no map of its lattice")
    coordinates = {name: ((name,), values, attributes(file[name])) for name, values in layout.axes.items()}
    scalars = {name: ((), data[()], attributes(data)) for name, data in file.items() if isinstance(data, h5py.Dataset)
               and data.shape == () and data.dtype.kind == "f" and name not in variables}
    root = {name: value for name, value in attributes(file).items()
            if name.removeprefix("best_") not in OPTIMUM}
    dataset = xarray.Dataset(variables, {**coordinates, **scalars}, {**root, "archive": layout.path})
    return dataset.transpose(*layout.outer, *AXES, ...)
