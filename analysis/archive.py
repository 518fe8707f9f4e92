"""Reads archives of trebsweep: axes, maps, which tiles are done, and the optimum."""

import contextlib
import copy
import os
import signal
import sys
import tempfile

from launch import check, find_program, run_program
from program import existing, fail, note, refuse  # before modules that may be missing

import h5py
import numpy as np

from job import job_text, parse_job
from lattice import read_lattices

AXES = ("r1", "r3", "r2")
WHOLE_LATTICE = (slice(None),) * len(AXES)
OPTIMUM = ("value", "speed", *AXES, "release_time", "error")  # best_...: datasets of a study


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


def open_archive(path):
    """Opens an archive, or a snapshot of the unfinished sweep in a folder FILE.partial."""
    if not (path.endswith(".partial") and os.path.isdir(path)):
        return open_file(path)
    with tempfile.TemporaryDirectory() as directory:
        snapshot = os.path.join(directory, "snapshot.h5")
        check(run_program(find_program(), "info", path, "--snapshot", snapshot))
        return open_file(snapshot)  # stays open after its removal


@contextlib.contextmanager
def limited_cpu_time(seconds=20):
    """Ends the program if HDF5 loops on a damaged file; waiting for a disk does not count."""
    signal.setitimer(signal.ITIMER_PROF, seconds)
    yield
    signal.setitimer(signal.ITIMER_PROF, 0)


class Archive:
    """An archive opened for reading.

    A tile is done if it has designs in the dataset tile_designs: the cells of other tiles read as
    NaN (maps of numbers) or 0 (maps of flags), whatever the file holds there.

    The archive of a study has outer axes. scene() selects one of its scenes, and the result behaves
    like the archive of that scene alone. Maps and optimum can only be read from one scene.

    outer_axes  {dataset: values} of the axes over scenes
    scenes      the numbers of the scenes, an array over the outer axes
    axes        {name: values in m} of r1, r3, r2; in a study, those of all scenes
    shape       their lengths
    done        whether each tile is done
    """

    def __init__(self, path):
        """Opens the archive at `path`, or its unfinished sweep if only this one exists; ends the
        program with a message if it is neither."""
        self.path = path = existing(path.rstrip("/"))
        with limited_cpu_time():
            self.file = open_archive(path)
            with reading(path, "is damaged"):
                missing = [name for name in (*AXES, "tile_block") if name not in self.file]
                if missing:
                    fail(f"{path}: is not an archive of trebsweep: it has no {missing[0]}")
                self.attributes = dict(self.file.attrs)
                self.job = parse_job(str(self.attributes["job"]))
                self.axes = self.box = {name: self._axis(name) for name in AXES}
                self.outer_axes = {name: self._axis(name) for name in outer_names(self.job)}
                self.in_study = bool(self.outer_axes)
                self.shape = tuple(map(len, self.axes.values()))
                self.outer_shape = tuple(map(len, self.outer_axes.values()))
                self.scenes = np.arange(np.prod(self.outer_shape, dtype=int)).reshape(
                    self.outer_shape)
                self.selected = {}  # {dataset: value} of the outer axes that select() removed
                self.fields = [name for name, item in self.file.items() if isinstance(
                    item, h5py.Dataset) and item.shape == (*self.outer_shape, *self.shape)]
                if not self.fields and self.job.get(("output", "maps")) != "none":
                    raise ValueError("it has no map of its lattice")
                self._read_tiles()
                if not self.in_study:
                    self._enter_scene()
        if not self.in_study:
            self.report_progress()

    def _axis(self, name):
        """The values of an axis."""
        values = self.file[name][...]
        if values.ndim != 1 or not values.size or not np.isfinite(values).all() or (
                np.diff(values) <= 0).any():
            raise ValueError(f"{name} is not an axis of increasing values")
        return values

    def _read_tiles(self):
        """Reads the tiles, which are done, the lattices of the scenes, and their first tiles."""
        blocks = self.file["tile_block"][...].astype(np.int64)
        self.done = self.tile_done = self.file["tile_designs"][...].any(axis=1)
        of_scene, self.tile_first, count = blocks[:, 0], blocks[:, 1:4], blocks[:, 4:]
        self.edge = tuple(count.max(axis=0))
        self.first_tile = np.searchsorted(of_scene, np.arange(self.scenes.size + 1))
        if len(self.done) != len(blocks) or (blocks < 0).any() or (np.diff(of_scene) < 0).any() or (
                count < 1).any() or of_scene[-1] >= self.scenes.size or (
                    self.tile_first + count > self.shape).any():
            raise ValueError("tile_block has invalid tiles")
        self.lattices = read_lattices(self.file)
        self.lattice_of = self.file["scene_lattice"][...].astype(np.int64)
        if self.lattice_of.shape != self.scenes.shape or not np.isin(
                self.lattice_of, np.arange(len(self.lattices))).all():
            raise ValueError("scene_lattice has invalid lattices")

    def _enter_scene(self):
        """Restricts axes and tiles to the only scene that is left."""
        scene = self.scenes.item()
        self.lattice = self.lattices[self.lattice_of.ravel()[scene]]
        self.axes = {name: self.box[name][own] for name, own in zip(AXES, self.lattice.own)}
        box = tuple(map(len, self.box.values()))
        self.shape = tuple(map(len, self.axes.values()))
        self.outer_index = tuple(map(int, np.unravel_index(scene, self.outer_shape)))
        tiles = slice(*self.first_tile[[scene, scene + 1]])
        self.blank_tiles = np.zeros([-(-n // edge) for n, edge in zip(box, self.edge)], bool)
        self.blank_tiles[tuple((self.tile_first[tiles] // self.edge).T)] = ~self.tile_done[tiles]

    def select(self, at, option="at"):
        """The archive without some outer axes: those of `at`, pairs (key, value), and those with
        one value. Ends the program, with a message about `option`, if the study has no such scene.
        """
        view = copy.copy(self)
        for key, value in at:
            name = key.replace("-", "_")
            if not self.in_study:
                refuse(option, f"{key}={value:g}",
                       f"must be left out: {self.path} is not a study")
            if name not in view.outer_axes:
                refuse(option, f"{key}={value:g}",
                       f"must name an outer axis of {self.path}, each once: "
                       + ", ".join(map(key_of, self.outer_axes)))
            if value not in view.outer_axes[name]:
                refuse(option, f"{key}={value:g}", f"must be one of {view.values_text(name)}")
            view._take(name, value)
        for name, values in self.outer_axes.items():
            if len(values) == 1 and name in view.outer_axes:
                view._take(name, values[0])
        view.selected = {**self.selected, **{name: view.selected[name] for name in self.outer_axes
                                             if name in view.selected}}
        if self.in_study:
            view._enter_selection()
            view.report_progress()
        return view

    def _take(self, name, value):
        """Selects a value of an outer axis."""
        axis = list(self.outer_axes).index(name)
        index = int(np.flatnonzero(self.outer_axes[name] == value)[0])
        self.scenes = self.scenes.take(index, axis)
        self.outer_axes = {other: x for other, x in self.outer_axes.items() if other != name}
        self.selected = {**self.selected, name: float(value)}
        self.job = {**self.job, ("scene", key_of(name)): plain_number(value)}

    def _enter_selection(self):
        """Restricts what is done, and the job, to the scenes that are left."""
        self.attributes = {**self.attributes, "job": job_text(self.job)}
        self.done = np.concatenate([self.tile_done[slice(*self.first_tile[[n, n + 1]])]
                                    for n in self.scenes.ravel()])
        if not self.outer_axes:
            self._enter_scene()

    def scene(self, at=(), option="at"):
        """The archive of one scene; ends the program, with a message about `option`, unless `at`
        selects one."""
        view = self.select(at, option)
        if view.outer_axes:
            axes = " and ".join(f"{key_of(name)} ({view.values_text(name)})"
                                for name in view.outer_axes)
            choice = " ".join(f"--{option} {key_of(name)}={values[0]:.15g}"
                              for name, values in view.outer_axes.items())
            note(f"{self.path}: is a study over {axes}; choose a scene, such as {choice}")
            sys.exit(2)
        return view

    def restricted(self, indices):
        """The archive of a scene with only some values of its axes, given by their indices."""
        view = copy.copy(self)
        view.lattice = self.lattice._replace(
            own=[own[index] for own, index in zip(self.lattice.own, indices)])
        view.axes = {name: values[index]
                     for (name, values), index in zip(self.axes.items(), indices)}
        view.shape = tuple(map(len, view.axes.values()))
        return view

    def indices_between(self, name, first, last):
        """The indices of an axis's values in [first, last]; ends the program if it has
        no value there."""
        values = self.outer_axes[name] if name in self.outer_axes else self.box[name]
        slack = 1e-9 * max(abs(first), abs(last))
        index = np.flatnonzero((values >= first - slack) & (values <= last + slack))
        if not index.size:
            refuse("box", f"{key_of(name)}={first:g}:{last:g}",
                   f"must hold a value of the axis, from {values[0]:g} to {values[-1]:g} "
                   f"{self.unit(name)}".rstrip())
        return index

    def between(self, name, first, last):
        """The archive without the values of an outer axis outside [first, last]; ends the program
        if none is left."""
        view = copy.copy(self)
        index = self.indices_between(name, first, last)
        view.scenes = self.scenes.take(index, list(self.outer_axes).index(name))
        view.outer_axes = {**self.outer_axes, name: self.outer_axes[name][index]}
        return view

    def with_first(self, name):
        """The archive with an outer axis moved before the others."""
        view = copy.copy(self)
        view.scenes = np.moveaxis(self.scenes, list(self.outer_axes).index(name), 0)
        view.outer_axes = {name: self.outer_axes[name], **self.outer_axes}
        return view

    def each_scene(self):
        """The archives of the scenes, the last outer axis fastest."""
        for index in np.ndindex(self.scenes.shape):
            view = copy.copy(self)
            for (name, values), i in zip(self.outer_axes.items(), index):
                view._take(name, values[i])
            view._enter_selection()
            yield view

    def scene_values(self, key):
        """The values of a number of [scene] in the scenes, an array over the outer axes."""
        name = key.replace("-", "_")
        if name not in self.outer_axes:
            return np.full(self.scenes.shape, float(self.job.get(("scene", key), 0)))
        axis = list(self.outer_axes).index(name)
        values = self.outer_axes[name].reshape([-1 if i == axis else 1
                                                for i in range(self.scenes.ndim)])
        return np.broadcast_to(values, self.scenes.shape)

    def optima(self):
        """{column of OPTIMUM: values} of the scenes, arrays over the outer axes; NaN where a scene
        is not done or has no optimum."""
        with reading(self.path, "is damaged"):
            done = np.logical_and.reduceat(self.tile_done, self.first_tile[:-1])
            return {name: np.where(done, self.file[f"best_{name}"][...].ravel(), np.nan)[
                self.scenes] for name in OPTIMUM}

    @property
    def complete(self):
        """Whether every tile is done."""
        return bool(self.done.all())

    def progress(self):
        """The progress of an unfinished archive, as text."""
        return f"unfinished: {self.done.sum()} of {self.done.size} tiles done"

    def report_progress(self):
        """Prints the progress of an unfinished archive on stderr."""
        if not self.complete:
            note(f"{self.path}: {self.progress()}; the rest is left blank")

    @property
    def free_axes(self):
        """The axes with more than one value."""
        return [name for name in AXES if len(self.axes[name]) > 1]

    def field(self, name):
        """The name of a field's dataset; ends the program if the archive has no such map."""
        dataset = name.replace("-", "_")
        if not self.fields:
            fail(f"{self.path}: has no maps (output.maps = none)")
        if dataset not in self.fields:
            maps = ", ".join(self.fields)
            refuse("field", name, f"{self.path} has no map {dataset}; must be one of {maps}")
        return dataset

    def number_field(self, name):
        """The same; also ends the program if the map holds flags."""
        dataset = self.field(name)
        if not self.is_number(dataset):
            numbers = ", ".join(field for field in self.fields if self.is_number(field))
            refuse("field", name, f"holds flags; must be a map of numbers: {numbers}")
        return dataset

    def is_number(self, field):
        """Whether a map holds numbers rather than flags."""
        return self.file[field].dtype.kind == "f"

    def read(self, field, where=WHOLE_LATTICE):
        """The values of a map at `where`, an index or a slice per axis; NaN or 0 where not done."""
        with reading(self.path, f"cannot read map {field}"):
            places = [own[w] for own, w in zip(self.lattice.own, where)]
            ranges = [place if place.ndim == 0 else slice(place[0], place[-1] + 1)
                      for place in places]
            values = self.file[field][(*self.outer_index, *ranges)]
            for axis, place in enumerate(place for place in places if place.ndim):
                if len(place) < values.shape[axis]:  # they need not be consecutive in the archive
                    values = values.take(place - place[0], axis)
        tiles = np.ix_(*(np.atleast_1d(place) // edge for place, edge in zip(places, self.edge)))
        blank = self.blank_tiles[tiles].reshape(np.shape(values))
        return np.where(blank, np.array(np.nan if self.is_number(field) else 0, values.dtype),
                        values)

    def released(self):
        """How many designs of the scene have a release."""
        with reading(self.path, "is damaged"):
            designs = self.file["tile_designs"]
            columns = str(designs.attrs["columns"]).split()
            rows = designs[slice(*self.first_tile[[self.scenes.item(), self.scenes.item() + 1]])]
            return sum(rows[:, columns.index(status)].sum()
                       for status in ("released", "released_below_ground"))

    @property
    def objective(self):
        """The name of the field that is largest at the optimum, and its unit."""
        with reading(self.path, "is damaged"):
            return (str(self.attributes["objective"]),
                    unit_text(str(self.attributes["objective_units"])))

    @property
    def refined(self):
        """Whether the optimum lies between the designs of the lattice (optimum.refine = yes)."""
        return self.complete and self.job.get(("optimum", "refine")) == "yes"

    def optimum(self):
        """({axis: value in m}, value of the objective) of the optimum so far, or None."""
        if not self.done.any():
            return None
        with reading(self.path, "is damaged"):
            best = {name: float(self.file[f"best_{name}"][self.outer_index] if self.in_study
                                else self.attributes[f"best_{name}"]) for name in ("value", *AXES)}
        return None if np.isnan(best["value"]) else (
            {name: best[name] for name in AXES}, best["value"])

    def design(self, index):
        """{axis: value in m} of the design with an index (i1, i3, i2)."""
        return {name: float(self.axes[name][i]) for name, i in zip(AXES, index)}

    def nearest(self, axis, value):
        """The index of the axis's value nearest to `value`."""
        return int(np.argmin(np.abs(self.axes[axis] - value)))

    def index(self, axis, value):
        """The index of a value on an axis. Ends the program if the value is not on the axis."""
        values = self.axes[axis]
        index = self.nearest(axis, value)
        if not np.isclose(value, values[index], rtol=1e-9, atol=0):
            near = " or ".join(f"{x:.10g}" for x in sorted(values[max(index - 1, 0):index + 2],
                                                           key=lambda x: abs(x - value))[:2])
            refuse(axis, f"{value:.10g}", f"must be a value of the axis in {self.path}, such as "
                   f"{near} m, from {values[0]:.10g} to {values[-1]:.10g} m")
        return index

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
            text = "no released design qualifies" if self.released() else "nothing released"
            return text if self.complete else f"{text} yet"
        design, value = optimum
        name, unit = self.objective
        amount = f"{value:.8f} m/s" if name == "speed" else f"{name} {value:.10g} {unit}".rstrip()
        between = ", between the designs" if self.refined else ""
        return f"{amount} at {design_text(design)}{between}"

    def conditions(self):
        """The conditions that the optimum satisfies, as texts."""
        texts = {"with a taut sling": self.job.get(("output", "optimum")) == "taut",
                 "within the constraints": self.job.get(("optimum", "subject-to"))}
        return [text for text, applies in texts.items() if applies]

    def best_word(self):
        """What the optimum is among the designs, such as "fastest with a taut sling"."""
        word = "fastest" if self.objective[0] == "speed" else "optimum"
        return " ".join([word, *self.conditions()])

    def with_scene(self, name):
        """A name of the archive, followed by the outer axes' values selected."""
        texts = [f"{key_of(axis)} = {value:.6g} {self.unit(axis)}".rstrip()
                 for axis, value in self.selected.items()]
        return ", ".join([name, *texts])

    def name(self):
        """The file's name without directory and suffix, and the outer axes' values selected."""
        return self.with_scene(os.path.basename(stem(self.path)))

    def values_text(self, name):
        """The values of an outer axis as text: "50, 60, 70, ..., 200 kg"."""
        texts = [f"{value:.15g}" for value in self.outer_axes[name]]
        if len(texts) > 8:
            texts[3:-1] = ["..."]
        return f"{', '.join(texts)} {self.unit(name)}".rstrip()

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

    def short_name(self, axis):
        """The same without remarks in brackets or after ", where"."""
        return self.long_name(axis).split(" (")[0].split(", where")[0]

    def meanings(self, field):
        """The meanings of the flags 0, 1, ... of a map."""
        words = self.attribute(field, "flag_meanings").split()
        if len(words) < 2:
            fail(f"{self.path}: is damaged: map {field} lacks the meanings of its flags")
        return [word.replace("_", " ") for word in words]


def outer_names(job):
    """The datasets of a job's outer axes: the keys of [scene] with several values."""
    return [key.replace("-", "_") for (section, key), value in job.items()
            if section == "scene" and key != "file" and (":" in value or "," in value)]


def key_of(dataset):
    """The key or the field of the job file that a dataset is named after."""
    return dataset.replace("_", "-")


def plain_number(value):
    """A number as in a job file."""
    return repr(float(value)).removesuffix(".0")


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


def stem(path, at=()):
    """The path of a file without .partial and its suffix, and with the values of a scene."""
    name = os.path.splitext(path.removesuffix(".partial"))[0]
    return "-".join([name, *(f"{key}={plain_number(value)}" for key, value in at)])
