"""What `import trebsweep` offers: archives as datasets, sweeps, optima and swings."""

from __future__ import annotations

import dataclasses
import os
import re
import tempfile
from typing import Any

import pandas
import xarray

from .backend import Archive
from .launch import checked, command, find_program, parse_optimum, run_program
from .program import existing, fail
from .swing import read_table


def open_archive(path: str | os.PathLike, chunks: Any = None) -> xarray.Dataset:
    """Opens an archive, or the unfinished sweep FILE.partial, or what xarray has saved of archives, without reading
    its maps.

    chunks  as of xarray.open_dataset, which needs dask
    The dataset has the dimensions (outer axes of a study..., r1, r3, r2) and
      r1, r3, r2 and outer axes  coordinates, in m and in the units of the SI
      speed, ...                 a map per field: numbers, NaN without a release, outside the lattice and where the
                                 sweep is not done; units in .attrs
      status, slack              flags, uint8: 0 outside the lattice; .attrs["flag_meanings"]
      best_value, best_r1, ...   (outer axes...) the optimum of each scene
    and the accessor .treb.
    """
    name = existing(os.fspath(path).rstrip("/"))
    if not (name.endswith(".partial") and os.path.isdir(name)):
        return xarray.open_dataset(name, engine=Archive, chunks=chunks)
    with tempfile.TemporaryDirectory() as directory:
        snapshot = os.path.join(directory, "snapshot.h5")
        checked(run_program(find_program(), "info", name, "--snapshot", snapshot))
        return xarray.open_dataset(snapshot, engine=Archive, chunks=chunks).assign_attrs(archive=name)  # stays open


def run(job: str | os.PathLike, ranks: int | None = None, overwrite: bool = False, program: str | None = None,
        **keys: Any) -> xarray.Dataset:
    """Sweeps a job, the path or the text of a job file, and opens the archive.

    ranks  of mpirun (default: one, without mpirun)
    keys   of the job file, with _ for -: projectile_mass=[50, 100], output_file="study.h5"
    """
    words = ["--progress=none", *(["--overwrite"] if overwrite else [])]
    text = checked(command("sweep", os.fspath(job), *words, ranks=ranks, program=program, **keys))
    found = re.search(r"(?m)^archive +(.*)$", text)
    return open_archive(found[1] if found else fail(f"{job}: the sweep named no archive"))


@dataclasses.dataclass(frozen=True)
class Optimum:
    """What `trebsweep optimum --json` found; `json` has the rest."""

    objective: str                  # a field or a formula
    value: float                    # of the objective, SI
    error: float                    # of the value
    r1: float                       # m
    r2: float                       # m
    r3: float                       # m
    release_time: float             # s
    values: dict[str, float]        # {field: value}, SI
    warnings: list[str]             # in what the design cannot be built
    json: dict[str, Any] = dataclasses.field(repr=False)

    @property
    def job(self) -> str:
        """The text of the job as searched."""
        return str(self.json["job"])


def optimum(job: str | os.PathLike, ranks: int | None = None, program: str | None = None, **keys: Any) -> Optimum:
    """Searches for the best design of a job; arguments as of run()."""
    found = parse_optimum(command("optimum", os.fspath(job), "--json", "--progress=none", ranks=ranks, program=program,
                                  **keys))
    names = [field.name for field in dataclasses.fields(Optimum) if field.name != "json"]
    return Optimum(**{name: found[name] for name in names}, json=found)


def trace(job: str | os.PathLike, r1: float, r2: float, r3: float, interval: float | None = None, flight: bool = False,
          program: str | None = None, **keys: Any) -> pandas.DataFrame:
    """The swing of a design, a row per time, or its flight from the release to the impact.

    r1, r2, r3  lengths, m
    interval    between rows, s
    Columns as `trebsweep trace --help` explains; .attrs["units"] has their units, and .attrs["comments"] the heights,
    the times of lift-off and release, and the least clearance and tensions, {key: text}.
    """
    words = [f"--{name}={float(length)!r}" for name, length in (("r1", r1), ("r2", r2), ("r3", r3))]
    words += [*([f"--interval={float(interval)!r}"] if interval else []), *(["--flight"] if flight else [])]
    return read_table(checked(command("trace", os.fspath(job), *words, program=program, **keys)), "trebsweep trace")
