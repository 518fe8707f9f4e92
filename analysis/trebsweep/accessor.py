"""The accessor `treb` of archives opened with trebsweep.open(): best designs, planes, pictures, the scene, the job."""

from __future__ import annotations

import io
import itertools
import os
from typing import Any, Iterator

import numpy as np
import pandas
import xarray

from .backend import AXES, OPTIMUM
from .expressions import Expression
from .job import job_text, parse_job
from .program import fail, key_of, refuse

BLOCK = 64        # cells: the most along an axis of a tile
MOST = 1 << 21    # cells that are held in memory at once
SAMPLE = 1000     # of pairs of a front
NO_MAPS = {"lattice_r1", "lattice_r3_r2", "tiles", "tiles_done", "released", *(f"best_{name}" for name in OPTIMUM)}


@xarray.register_dataset_accessor("treb")
class Treb:
    """What a dataset of trebsweep.open() can do beyond xarray.

    Lengths are in m, other numbers in the units of the SI. A `field` is the name of a map, with _ or -, or, where
    this is said, an expression of maps, lengths and numbers of the scene, such as "range / r1" or "-peak_axle_load".
    """

    def __init__(self, dataset: xarray.Dataset):
        self.data = dataset

    # What the archive holds.

    @property
    def path(self) -> str:
        """The path of the file."""
        return str(self.data.attrs.get("archive", "archive"))

    @property
    def outer(self) -> list[str]:
        """The outer axes of a study: names of dimensions."""
        return [str(name) for name in self.data.lattice_r1.dims if name != "r1"] if "lattice_r1" in self.data else [
            str(name) for field in self.fields[:1] for name in self.data[field].dims if name not in AXES]

    @property
    def outer_axes(self) -> dict[str, np.ndarray]:
        """{outer axis: its values}."""
        return {name: self.data[name].values for name in self.outer}

    @property
    def outer_shape(self) -> tuple[int, ...]:
        """Their lengths."""
        return tuple(self.data.sizes[name] for name in self.outer)

    def first(self, *names: str) -> Treb:
        """The archive with some outer axes before the others."""
        return self.data.transpose(*names, ...).treb

    @property
    def selected(self) -> dict[str, float]:
        """{outer axis: value} of those that were selected."""
        return {str(name): float(x) for name, x in self.data.coords.items() if x.ndim == 0 and name not in AXES}

    @property
    def in_study(self) -> bool:
        """Whether the archive has, or had, outer axes."""
        return bool(self.outer or self.selected)

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """{r1, r3, r2: values, m}."""
        return {name: self.data[name].values for name in AXES}

    @property
    def free_axes(self) -> list[str]:
        """The axes of the lattice with more than one value."""
        return [name for name in AXES if self.data.sizes[name] > 1]

    @property
    def fields(self) -> list[str]:
        """The names of the maps."""
        return [str(name) for name in self.data.data_vars if name not in NO_MAPS]

    @property
    def keys(self) -> dict[tuple[str, str], str]:
        """{(section, key): value} of the job as run, in the scene that is selected."""
        chosen = {("scene", key_of(name)): plain_number(value) for name, value in self.selected.items()}
        return {**parse_job(str(self.data.attrs.get("job", ""))), **chosen}

    @property
    def job(self) -> str:
        """The text of the job as run, in the scene that is selected: it runs again to the same maps."""
        return job_text(self.keys) if self.selected else str(self.data.attrs.get("job", ""))

    @property
    def scene(self) -> dict[str, float | str]:
        """{key: value} of [scene], with _ for -: numbers in the units of the SI, or words."""
        return {key.replace("-", "_"): number_or_text(text) for (section, key), text in self.keys.items()
                if section == "scene"}

    @property
    def numbers(self) -> dict[str, float]:
        """Those of .scene that are one number."""
        return {key: value for key, value in self.scene.items() if isinstance(value, float)}

    # Descriptions.

    def unit(self, name: str) -> str:
        """The unit of a map or an axis in common notation, "" if it has none."""
        return unit_text(str(self.data[name].attrs.get("units", "")))

    def long_name(self, name: str) -> str:
        """The description of a map or an axis."""
        return str(self.data[name].attrs.get("long_name", name.replace("_", " ")))

    def short_name(self, name: str) -> str:
        """The same without remarks in brackets or after ", where"."""
        return self.long_name(name).split(" (")[0].split(", where")[0]

    def meanings(self, field: str) -> list[str]:
        """The meanings of the flags 0, 1, ... of a map."""
        words = str(self.data[field].attrs.get("flag_meanings", "")).split()
        if len(words) < 2:
            fail(f"{self.path}: is damaged: map {field} lacks the meanings of its flags")
        return [word.replace("_", " ") for word in words]

    def with_scene(self, name: str) -> str:
        """A name of the archive, followed by the outer axes' values selected."""
        return ", ".join([name, *(f"{key_of(axis)} = {value:.6g} {self.unit(axis)}".rstrip()
                                  for axis, value in self.selected.items())])

    def name(self) -> str:
        """The file's name without directory and suffix, and the outer axes' values selected."""
        return self.with_scene(os.path.basename(stem(self.path)))

    def values_text(self, name: str) -> str:
        """The values of an outer axis as text: "50, 60, 70, ..., 200 kg"."""
        texts = [f"{value:.15g}" for value in self.data[name].values]
        if len(texts) > 8:
            texts[3:-1] = ["..."]
        return f"{', '.join(texts)} {self.unit(name)}".rstrip()

    # Maps.

    def field(self, name: str) -> str:
        """The map that a field is stored as; refused unless there is one."""
        dataset = name.replace("-", "_")
        if not self.fields:
            fail(f"{self.path}: has no maps (output.maps = none)")
        if dataset not in self.fields:
            refuse("field", name, f"{self.path} has no map {dataset}; must be one of {', '.join(self.fields)}")
        return dataset

    def number_field(self, name: str) -> str:
        """The same; also refused if the map holds flags."""
        dataset = self.field(name)
        if not self.is_number(dataset):
            numbers = ", ".join(field for field in self.fields if self.is_number(field))
            refuse("field", name, f"holds flags; must be a map of numbers: {numbers}")
        return dataset

    def expression(self, text: str) -> Expression:
        """An expression that is a map of numbers, or a formula of maps."""
        name = text.replace("-", "_")
        return Expression("field", self.number_field(name) if name.isidentifier() else text)

    def is_number(self, field: str) -> bool:
        """Whether a map holds numbers rather than flags."""
        return "flag_meanings" not in self.data[field].attrs and self.data[field].dtype.kind == "f"

    def designs(self) -> xarray.DataArray:
        """Whether there is a design at each cell: bool (outer axes..., r1, r3, r2)."""
        if "lattice_r1" in self.data:
            both = self.data.lattice_r1.astype(bool) & self.data.lattice_r3_r2.astype(bool)
            return both.transpose(*self.outer, *AXES)
        if "status" in self.data:
            return self.data.status != 0
        return self.data[self.field(self.fields[0] if self.fields else "speed")].notnull()

    def index(self, axis: str, value: float) -> int:
        """The index of a value on an axis; refused if the value is not on the axis."""
        values = self.axes[axis]
        index = self.nearest(axis, value)
        if not np.isclose(value, values[index], rtol=1e-9, atol=0):
            near = " or ".join(f"{x:.10g}" for x in sorted(values[max(index - 1, 0):index + 2],
                                                           key=lambda x: abs(x - value))[:2])
            refuse(axis, f"{value:.10g}", f"must be a value of the axis in {self.path}, such as "
                   f"{near} m, from {values[0]:.10g} to {values[-1]:.10g} m")
        return index

    def nearest(self, axis: str, value: float) -> int:
        """The index of the axis's value nearest to `value`."""
        return int(np.argmin(np.abs(self.axes[axis] - value)))

    def section(self, field: str, names: list[str], centre: dict[str, float]) -> xarray.DataArray:
        """A map along the axes `names` at the values nearest to `centre` of the others."""
        others = {axis: self.nearest(axis, centre[axis]) for axis in AXES if axis not in names}
        return self.data[field].isel(others).transpose(*names)

    def plane(self, field: str = "speed", **at: float) -> xarray.DataArray:
        """A plane of a map of one scene, (axis, axis), through a value of the third axis: .plane("speed", r1=0.51)."""
        if len(at) != 1 or not set(at) <= set(AXES):
            refuse("plane", at, f"must be a value of one of {', '.join(AXES)}")
        (axis, value), = at.items()
        return self.data[self.field(field)].isel({axis: self.index(axis, value)})

    def at(self, **at: float) -> pandas.Series:
        """What is stored of one design, flags as words: .at(r1=0.51, r3=0.58, r2=0.91), and a value of each outer axis
        of a study. Values between those of the lattice are those of the nearest design."""
        given = {key.replace("-", "_"): value for key, value in at.items()}
        missing = [name for name in (*self.outer, *AXES) if name not in given]
        if missing or len(given) > len(self.outer) + len(AXES):
            refuse("at", at, f"must have one value of each of {', '.join([*self.outer, *AXES])}")
        return self.described(self.data.sel(given, method="nearest"))

    def described(self, design: xarray.Dataset) -> pandas.Series:
        """The values stored of one design, a dataset without dimensions."""
        values: dict[str, Any] = {str(name): float(design[name]) for name in (*self.outer, *AXES)}
        for field in self.fields:
            value = design[field].item()
            values[field] = value if self.is_number(field) else dict(enumerate(self.meanings(field))).get(value, value)
        return pandas.Series(values)

    # Scenes of a study.

    def select(self, at, option: str = "at") -> Treb:
        """The archive without the outer axes of `at`, pairs (key, value), and without those with one value; refused,
        with the name of the option, if the study has no such scene."""
        chosen: dict[str, float] = {}
        for key, value in at:
            name, text = key.replace("-", "_"), f"{key}={value:g}"
            if not self.in_study:
                refuse(option, text, f"must be left out: {self.path} is not a study")
            if name not in self.outer or name in chosen:
                refuse(option, text, f"must name an outer axis of {self.path}, each once: "
                       + ", ".join(map(key_of, self.outer)))
            if value not in self.data[name].values:
                refuse(option, text, f"must be one of {self.values_text(name)}")
            chosen[name] = value
        single = {name: self.data[name].values[0] for name in self.outer if self.data.sizes[name] == 1}
        return self.data.sel({**single, **chosen}).treb

    def only(self, at=(), option: str = "at") -> Treb:
        """The archive of one scene, without the values of r1, r3 and r2 at which it has no design; refused, with the
        name of the option, unless `at` selects one scene."""
        view = self.select(at, option)
        if view.outer:
            axes = " and ".join(f"{key_of(name)} ({view.values_text(name)})" for name in view.outer)
            choice = " ".join(f"--{option} {key_of(name)}={values[0]:.15g}" for name, values in view.outer_axes.items())
            fail(f"{self.path}: is a study over {axes}; choose a scene, such as {choice}", code=2)
        return view.trimmed()

    def trimmed(self) -> Treb:
        """One scene without the values of the axes at which it has no design."""
        if "lattice_r1" in self.data:
            plane = self.data.lattice_r3_r2.values.astype(bool)
            kept = {"r1": self.data.lattice_r1.values.astype(bool), "r3": plane.any(axis=1), "r2": plane.any(axis=0)}
        else:
            designs = self.designs().values
            kept = {name: designs.any(axis=tuple({0, 1, 2} - {i})) for i, name in enumerate(AXES)}
        return self.data.isel({name: whole(np.flatnonzero(flags)) for name, flags in kept.items()}).treb

    def each_scene(self) -> Iterator[Treb]:
        """The archives of the scenes as .only() gives them, the last outer axis fastest."""
        for index in np.ndindex(self.outer_shape):
            yield self.select([(name, self.data[name].values[i]) for name, i in zip(self.outer, index)]).trimmed() \
                if self.outer else self.trimmed()

    # Progress and optimum.

    @property
    def complete(self) -> bool:
        """Whether every tile is done."""
        return "tiles" not in self.data or bool((self.data.tiles_done == self.data.tiles).all())

    def progress(self) -> str:
        """The progress of an unfinished archive, as text."""
        return f"unfinished: {int(self.data.tiles_done.sum())} of {int(self.data.tiles.sum())} tiles done"

    @property
    def objective(self) -> tuple[str, str]:
        """The field that is largest at the optimum, and its unit."""
        attributes = self.data.attrs
        return str(attributes.get("objective", "speed")), unit_text(str(attributes.get("objective_units", "m s-1")))

    @property
    def refined(self) -> bool:
        """Whether the optimum lies between the designs of the lattice (optimum.refine = yes)."""
        return self.complete and self.keys.get(("optimum", "refine")) == "yes"

    def so_far(self) -> dict[str, np.ndarray]:
        """The optimum of each scene so far, {column: array over the outer axes}: value (of the objective), speed, r1,
        r3, r2, release_time, error (of the value); NaN where a scene has none."""
        if "best_value" in self.data:
            return {name: self.data[f"best_{name}"].values for name in OPTIMUM}
        # Several archives in one: the best designs of their maps.
        field = self.objective[0].replace("-", "_")
        table = pandas.concat([scene.best(1, field).reindex([0]) for scene in self.each_scene()])
        table["value"] = table[field]
        return {name: table.reindex(columns=[name]).to_numpy(float).reshape(self.outer_shape) for name in OPTIMUM}

    def optima(self) -> dict[str, np.ndarray]:
        """The same of the scenes that are done; NaN in the others."""
        done = self.data.tiles_done.values == self.data.tiles.values if "tiles" in self.data else True
        return {name: np.where(done, values, np.nan) for name, values in self.so_far().items()}

    def optimum(self) -> tuple[dict[str, float], float] | None:
        """({axis: m}, value of the objective) of the optimum of one scene so far, or None."""
        if "tiles" in self.data and not self.data.tiles_done.any():
            return None
        best = {name: float(values) for name, values in self.so_far().items()}
        return None if np.isnan(best["value"]) else ({name: best[name] for name in AXES}, best["value"])

    def best_text(self) -> str:
        """The optimum of one scene as text."""
        optimum = self.optimum()
        if optimum is None:
            none = not int(self.data.released) if "released" in self.data else False
            text = "nothing released" if none else "no released design qualifies"
            return text if self.complete else f"{text} yet"
        design, value = optimum
        name, unit = self.objective
        amount = f"{value:.8f} m/s" if name == "speed" else f"{name} {value:.10g} {unit}".rstrip()
        return f"{amount} at {design_text(design)}{', between the designs' if self.refined else ''}"

    def conditions(self) -> list[str]:
        """The conditions that the optimum satisfies, as texts."""
        texts = {"with a taut sling": self.keys.get(("output", "optimum")) == "taut",
                 "within the constraints": self.keys.get(("optimum", "subject-to"))}
        return [text for text, applies in texts.items() if applies]

    def best_word(self) -> str:
        """What the optimum is among the designs, such as "fastest with a taut sling"."""
        return " ".join(["fastest" if self.objective[0] == "speed" else "optimum", *self.conditions()])

    # Searches among all designs of all scenes.

    def blocks(self) -> Iterator[xarray.Dataset]:
        """Parts of the scenes that fit in memory."""
        sizes = [self.data.sizes[name] for name in AXES]
        steps = sizes if np.prod(sizes) <= MOST else [BLOCK, BLOCK, 2 * BLOCK]
        for index in np.ndindex(self.outer_shape):
            scene = self.data.isel(dict(zip(self.outer, index)))
            for first in itertools.product(*(range(0, size, step) for size, step in zip(sizes, steps))):
                yield scene.isel({name: slice(i, i + step) for name, i, step in zip(AXES, first, steps)})

    def found(self, fields: list[str], where: str | None, choose) -> pandas.DataFrame:
        """The designs that `choose` picks, again and again, from those found so far and those of the next part: their
        axes and the values of expressions. `choose` takes an array (expression, design), and returns indices."""
        fields = [field.replace("-", "_") if field.replace("-", "_") in self.fields else field for field in fields]
        expressions = [Expression("field", field) for field in fields]
        condition = Expression("where", where) if where else None
        names, first = [*self.outer, *AXES], len(self.outer) + len(AXES)
        rows = np.empty((first + len(fields) + len(self.fields), 0))
        for part in self.blocks():
            values = np.array([expression.values(part).ravel() for expression in expressions])
            good = np.isfinite(values).all(axis=0)
            if condition:
                good &= condition.flags(part).ravel()
            picked = np.flatnonzero(good)[choose(values[:, good])]
            known = rows[first:first + len(fields)]
            new = choose(np.hstack([known, values[:, picked]])) - known.shape[1]
            picked = picked[new[new >= 0]]
            if picked.size:  # else nothing more is read
                cells = np.unravel_index(picked, [part.sizes[name] for name in AXES])
                axes = [np.full(picked.size, float(part[name])) for name in self.outer] + [
                    part[name].values[i] for name, i in zip(AXES, cells)]
                rows = np.hstack([rows, np.vstack([*axes, values[:, picked],
                                                   *(part[field].values[cells] for field in self.fields)])])
                rows = rows[:, choose(rows[first:first + len(fields)])]
        table = pandas.DataFrame(rows.T, columns=[*names, *fields, *self.fields])
        for field in self.fields:
            if not self.is_number(field):
                table[field] = table[field].map(dict(enumerate(self.meanings(field))))
        return table.loc[:, ~table.columns.duplicated()]

    def best(self, n: int = 1, field: str | None = None, where: str | None = None) -> pandas.DataFrame:
        """The n designs of all scenes with the largest `field`, by default the objective of the archive, largest first.

        field  a map or an expression; "-peak_axle_load" finds the smallest
        where  a condition, such as "(r2 < 0.8) & (slack == 1)"; the constraints of the job do not count
        Columns: outer axes, r1, r3, r2 (m), the field if it is an expression, and all maps (SI), flags as words.
        """
        return self.found([field or self.objective[0]], where, lambda values: top(values[0], n))

    def pareto(self, a: str, b: str, where: str | None = None) -> pandas.DataFrame:
        """The front of two fields or expressions, both as large as possible: the designs of all scenes that no other
        design beats in both, in the order of decreasing `a`. Columns as of .best()."""
        return self.found([a, b], where, front)

    def to_csv(self, path: str | None = None, fields: list[str] | None = None) -> str | None:
        """Writes the designs of all scenes as comma-separated values, a row per design: outer axes, r1, r3, r2, maps,
        in SI units, flags as numbers; returns the text if there is no path."""
        names = [self.field(name) for name in fields or self.fields]
        with io.StringIO() if path is None else open(path, "w", encoding="utf-8") as file:
            for number, part in enumerate(self.blocks()):
                table = part[names].assign(there=part.treb.designs()).to_dataframe().reset_index()
                table.loc[table.pop("there"), [*self.outer, *AXES, *names]].to_csv(file, index=False, header=not number)
            return file.getvalue() if isinstance(file, io.StringIO) else None

    def heatmap(self, field: str | None = None, **at: float):
        """The figure of a map of one scene in three planes through its best design, or through values of r1, r3, r2."""
        from . import heatmap  # pylint: disable=import-outside-toplevel  # it needs this module
        one = self.only()
        return heatmap.picture(one, one.field(field or heatmap.default_field(one)), at)


def top(values: np.ndarray, n: int) -> np.ndarray:
    """The indices of the n largest values, largest first; of equal ones the first."""
    some = np.argpartition(-values, n - 1)[:n] if 0 < n < values.size else np.arange(values.size)
    some = np.flatnonzero(values >= values[some].min()) if some.size else some
    return some[np.argsort(-values[some], kind="stable")][:n]


def front(values: np.ndarray) -> np.ndarray:
    """The indices of the pairs, (2, pair), that no other pair beats, in the order of decreasing first values; of equal
    pairs the first."""
    places = np.arange(values.shape[1])
    if places.size > 4 * SAMPLE:  # most are beaten by one of a sample: they need no sorting
        sample = values[:, ::places.size // SAMPLE]
        first, second = sample[:, front(sample[:, :SAMPLE])]
        above = np.searchsorted(-first, -values[0], side="right")
        places = places[(above == 0) | (second[above - 1] <= values[1])]
    order = places[np.lexsort(-values[::-1, places])]
    highest = np.maximum.accumulate(values[1, order])
    return order[np.diff(highest, prepend=-np.inf) > 0]


def whole(indices: np.ndarray):
    """Indices as a slice if they are consecutive, which is read faster."""
    consecutive = indices.size and np.ptp(indices) + 1 == indices.size
    return slice(int(indices[0]), int(indices[-1]) + 1) if consecutive else indices


def number_or_text(text: str) -> float | str:
    """The number that a text is, else the text."""
    try:
        return float(text)
    except ValueError:
        return text


def plain_number(value: float) -> str:
    """A number as in a job file."""
    return repr(float(value)).removesuffix(".0")


def design_text(design: dict[str, float]) -> str:
    """A design, {axis: value in m}, as text."""
    return ", ".join(f"{name} = {design[name]:.7g}" for name in ("r1", "r2", "r3")) + " m"


def unit_text(unit: str) -> str:
    """A UDUNITS string in common notation: "m s-1" -> "m/s", "s-1" -> "1/s", "1" -> ""."""
    return {"s-1": "1/s", "1": ""}.get(unit, unit.replace(" s-1", "/s"))


def edges(values: np.ndarray) -> np.ndarray:
    """The boundaries of cells around increasing values."""
    if len(values) == 1:
        half = 0.01 * abs(values[0]) or 0.01
        return np.array([values[0] - half, values[0] + half])
    between = (values[1:] + values[:-1]) / 2
    return np.array([2 * values[0] - between[0], *between, 2 * values[-1] - between[-1]])


def stem(path: str, at=()) -> str:
    """The path of a file without .partial and its suffix, and with the values of a scene."""
    name = os.path.splitext(path.removesuffix(".partial"))[0]
    return "-".join([name, *(f"{key}={plain_number(value)}" for key, value in at)])
