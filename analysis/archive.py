"""Reads archives of trebsweep: axes, maps, which tiles are done, and the optimum."""

import contextlib
import os
import signal

from program import fail, note, refuse  # before modules that may be missing

import h5py
import numpy as np

AXES = ("r1", "r3", "r2")
WHOLE_LATTICE = (slice(None),) * len(AXES)


@contextlib.contextmanager
def reading(path, what):
    """Ends the program with one line if HDF5 fails or returns unexpected data."""
    try:
        yield
    except (OSError, KeyError, ValueError, TypeError, IndexError, RuntimeError, AttributeError,
            OverflowError) as error:
        fail(f"{path}: {what}: {error}")


def open_file(path):
    """Opens the HDF5 file at `path` for reading; exits with a message if it cannot be read."""
    if not os.path.isfile(path):
        fail(f"{path}: {'is a directory, not a file' if os.path.isdir(path) else 'no such file'}")
    with reading(path, "cannot be opened as an HDF5 file"):
        return h5py.File(path, "r")


@contextlib.contextmanager
def limited_cpu_time(seconds=20):
    """Ends the program if HDF5 loops on a damaged file; waiting for a disk does not count."""
    signal.setitimer(signal.ITIMER_PROF, seconds)
    yield
    signal.setitimer(signal.ITIMER_PROF, 0)


class Archive:
    """An archive opened for reading.

    Only the dataset tile_done decides what is complete: cells of tiles that are not done read as
    NaN (maps of numbers) or 0 (maps of flags), whatever the file holds there.
    """

    def __init__(self, path):
        """Opens the archive at `path`; ends the program with a message if it is not one."""
        self.path = path
        with limited_cpu_time():
            self.file = open_file(path)
            with reading(path, "is damaged"):
                missing = [name for name in (*AXES, "tile_done") if name not in self.file]
                if missing:
                    fail(f"{path}: is not an archive of trebsweep: it has no {missing[0]}")
                self.axes = {name: self._axis(name) for name in AXES}
                self.shape = tuple(map(len, self.axes.values()))
                self.fields = [name for name, item in self.file.items()
                               if isinstance(item, h5py.Dataset) and item.shape == self.shape]
                if not self.fields:
                    raise ValueError("it has no map of its lattice")
                self.attributes = dict(self.file.attrs)
                self.job = parse_job(str(self.attributes["job"]))
                self.done = self.file["tile_done"][...] == 1
                self.edge = tuple(int(self.file["tile_done"].attrs[f"edge_{name}"])
                                  for name in AXES)
                self.blank_tiles = self._blank_tiles()
        if not self.complete:
            note(f"{path}: {self.progress()}; the rest is left blank")

    def _axis(self, name):
        """The values of an axis, m."""
        values = self.file[name][...]
        if values.ndim != 1 or not values.size or not np.isfinite(values).all() or (
                np.diff(values) <= 0).any():
            raise ValueError(f"{name} is not an axis of increasing values")
        return values

    def _blank_tiles(self):
        """Whether each tile holds designs that are not done, as an array (r1, r3, r2) of bool."""
        if min(self.edge) < 1 or self.done.ndim != 1 or not self.done.size:
            raise ValueError("tile_done has invalid tiles")
        tiles = [range(0, n, edge) for n, edge in zip(self.shape, self.edge)]
        blank = np.zeros([len(firsts) for firsts in tiles], bool)
        if self.complete:
            return blank
        # Tiles are numbered along r2, then r3, then r1. Rows never become longer with r3,
        # so a tile holds a design if its lowest corner does.
        row = self._row_lengths()[tiles[1]]
        holds = np.broadcast_to(row[:, np.newaxis] > np.array(tiles[2]), blank.shape)
        if np.count_nonzero(holds) != self.done.size:
            raise ValueError(f"tile_done has {self.done.size} tiles instead of "
                             f"{np.count_nonzero(holds)}")
        blank[holds] = ~self.done
        return blank

    def _row_lengths(self):
        """The number of values of r2 in the lattice for each r3: those with r2 < h0 - r3, unless
        the job gives r2."""
        if ("lattice", "r2") in self.job:
            return np.full(self.shape[1], self.shape[2])
        r2 = self.axes["r2"]
        longest = float(self.job["scene", "fulcrum-height"]) - self.axes["r3"]
        return np.searchsorted(r2, longest - 1e-6 * r2[0])  # the tolerance of the program, in steps

    @property
    def complete(self):
        """Whether every tile is done."""
        return bool(self.done.all())

    def progress(self):
        """The progress of an unfinished archive, as text."""
        return f"unfinished: {self.done.sum()} of {self.done.size} tiles done"

    @property
    def free_axes(self):
        """The axes with more than one value."""
        return [name for name in AXES if len(self.axes[name]) > 1]

    def field(self, name):
        """The name of a field's dataset; ends the program if the archive has no such map."""
        dataset = name.replace("-", "_")
        if dataset not in self.fields:
            maps = ", ".join(self.fields)
            refuse("field", name, f"{self.path} has no map {dataset}; must be one of {maps}")
        return dataset

    def is_number(self, field):
        """Whether a map holds numbers rather than flags."""
        return self.file[field].dtype.kind == "f"

    def read(self, field, where=WHOLE_LATTICE):
        """The values of a map at `where`, an index or a slice per axis; NaN or 0 where not done."""
        with reading(self.path, f"cannot read map {field}"):
            values = self.file[field][where]
        tiles = np.ix_(*(np.atleast_1d(np.arange(n)[w]) // edge
                         for n, w, edge in zip(self.shape, where, self.edge)))
        blank = self.blank_tiles[tiles].reshape(np.shape(values))
        return np.where(blank, np.array(np.nan if self.is_number(field) else 0, values.dtype),
                        values)

    def tallies(self):
        """{column: values} of tile_tally in the tiles that are done."""
        with reading(self.path, "is damaged"):
            tally = self.file["tile_tally"]
            return dict(zip(str(tally.attrs["columns"]).split(), tally[...][self.done].T))

    @property
    def objective(self):
        """The name of the field that is largest at the optimum, and its unit."""
        # Archives before format version 6 lack these attributes.
        return (str(self.attributes.get("objective", "speed")),
                unit_text(str(self.attributes.get("objective_units", "m s-1"))))

    @property
    def refined(self):
        """Whether the optimum lies between the designs of the lattice (optimum.refine = yes)."""
        return np.isfinite(self.attributes.get("refined_error", np.nan))

    def optimum(self):
        """({axis: value in m}, value of the objective) of the optimum so far, or None.

        Unless it is refined, it comes from the tallies of the tiles: the root attributes hold it
        only after the last.
        """
        if self.refined:
            return ({name: float(self.attributes[f"best_{name}"]) for name in AXES},
                    float(self.attributes["best_value"]))
        rows = self.tallies()
        with reading(self.path, "is damaged"):
            found = rows["best_cell"] >= 0
            if not found.any():
                return None
            cells, values = (rows[name][found] for name in (
                "best_cell", "best_value" if "best_value" in rows else "best_speed"))
            cell = int(cells[values == values.max()].min())  # the first of equals
            return self.design(np.unravel_index(cell, self.shape)), float(values.max())

    def design(self, index):
        """{axis: value in m} of the design with an index (i1, i3, i2)."""
        return {name: float(self.axes[name][i]) for name, i in zip(AXES, index)}

    def nearest(self, axis, value):
        """The index of the axis's value nearest to `value`."""
        return int(np.argmin(np.abs(self.axes[axis] - value)))

    def index(self, axis, value):
        """The same; ends the program if `value` lies outside the axis."""
        values = self.axes[axis]
        limits = edges(values)
        if not limits[0] <= value <= limits[-1]:
            refuse(axis, f"{value:g}",
                   f"must be from {values[0]:g} to {values[-1]:g} m, as in {self.path}")
        return self.nearest(axis, value)

    def extreme(self, field, largest):
        """({axis: value in m}, value) of the largest or smallest value of a map, or None."""
        best, sign = None, 1 if largest else -1
        for first in range(0, self.shape[0], self.edge[0]):  # a whole map may not fit in memory
            slab = (slice(first, first + self.edge[0]), *WHOLE_LATTICE[1:])
            values = sign * self.read(field, slab)
            if not np.isfinite(values).any():
                continue
            index = np.unravel_index(np.argmax(np.where(np.isfinite(values), values, -np.inf)),
                                     values.shape)
            if best is None or values[index] > best[1]:
                best = ((first + index[0], *index[1:]), float(values[index]))
        return best and (self.design(best[0]), sign * best[1])

    def best_text(self):
        """The optimum as text."""
        optimum = self.optimum()
        if optimum is None:
            rows = self.tallies()
            with reading(self.path, "is damaged"):
                released = sum(rows[name].sum() for name in ("released", "released_below_ground"))
            text = "no released design qualifies" if released else "nothing released"
            return text if self.complete else f"{text} yet"
        design, value = optimum
        name, unit = self.objective
        amount = f"{value:.8f} m/s" if name == "speed" else f"{name} {value:.10g} {unit}".rstrip()
        between = ", between the designs" if self.refined else ""
        return f"{amount} at {design_text(design)}{between}"

    def best_word(self):
        """What the optimum is among the designs, such as "fastest with a taut sling"."""
        word = "fastest" if self.objective[0] == "speed" else "optimum"
        if self.job.get(("output", "optimum")) == "taut":
            word += " with a taut sling"
        return word + (" within the constraints" if self.job.get(("optimum", "subject-to")) else "")

    def name(self):
        """The file's name without directory and suffix."""
        return os.path.basename(stem(self.path))

    def attribute(self, dataset, name, default=""):
        """A text attribute of a dataset."""
        with reading(self.path, "is damaged"):
            return str(self.file[dataset].attrs.get(name, default))

    def unit(self, field):
        """The unit of a map or an axis in common notation, "" if it has none."""
        return unit_text(self.attribute(field, "units"))

    def long_name(self, field):
        """The description of a map or an axis."""
        return self.attribute(field, "long_name", field.replace("_", " "))

    def meanings(self, field):
        """The meanings of the flags 0, 1, ... of a map."""
        words = self.attribute(field, "flag_meanings").split()
        if len(words) < 2:
            fail(f"{self.path}: is damaged: map {field} lacks the meanings of its flags")
        return [word.replace("_", " ") for word in words]


def parse_job(text):
    """Parses the text of a job file into {(section, key): value}."""
    values, section = {}, ""
    for line in text.splitlines():
        if line.startswith("["):
            section = line.strip("[]")
        elif "=" in line:
            key, value = line.split("=", 1)
            values[section, key.strip()] = value.strip()
    return values


def design_text(design):
    """A design, {axis: value in m}, as text."""
    return ", ".join(f"{name} = {design[name]:.7g}" for name in ("r1", "r2", "r3")) + " m"


def unit_text(unit):
    """A UDUNITS string in common notation: "m s-1" -> "m/s", "s-1" -> "1/s", "1" -> ""."""
    return {"s-1": "1/s", "1": ""}.get(unit, unit.replace(" s-1", "/s"))


def edges(values):
    """The boundaries of cells around increasing values."""
    if len(values) == 1:
        half = 0.01 * abs(values[0]) or 0.01
        return np.array([values[0] - half, values[0] + half])
    between = (values[1:] + values[:-1]) / 2
    return np.array([2 * values[0] - between[0], *between, 2 * values[-1] - between[-1]])


def stem(path):
    """The path of a file without .partial and its suffix."""
    return os.path.splitext(path.removesuffix(".partial"))[0]
