"""Tables that `trebsweep trace` prints."""

from __future__ import annotations

import io

import numpy as np
import pandas

from .program import fail

# Descriptions and units of the columns.
COLUMNS = {
    "t": ("time t", "s"), "phi1": (r"$\phi_1$, counterweight arm", "rad"), "phi2": (r"$\phi_2$, sling", "rad"),
    "phi3": (r"$\phi_3$, hanger", "rad"), "w1": ("angular velocity of the arm", "rad/s"),
    "w2": ("angular velocity of the sling", "rad/s"), "w3": ("angular velocity of the hanger", "rad/s"),
    **{f"{axis}{body}": (f"{axis} of the {text}", "m") for axis in "xy" for body, text in (
        ("1", "counterweight"), ("h", "hinge"), ("t", "arm's tip"), ("3", "projectile"))},
    "vx": ("horizontal velocity", "m/s"), "vy": ("vertical velocity", "m/s"), "speed": ("speed", "m/s"),
    "energy": ("energy", "J"), "tension": ("sling tension at the projectile", "N"),
    "tip_tension": ("sling tension at the arm's tip", "N"), "axle": ("force on the axle", "N"),
    "stress": ("bending stress at the fulcrum", "Pa"), "hanger_tension": ("tension of the hanger", "N"),
    "normal": ("force of the trough on the projectile", "N")}
SWING = ("t", "phi1", "phi2", "x1", "y1", "xt", "yt", "x3", "y3", "speed")
FLIGHT = ("t", "x3", "y3", "speed")


def read_table(text: str, name: str, columns: tuple[str, ...] = ("t",)) -> pandas.DataFrame:
    """The rows of finite numbers of a table, which must have the given columns; .attrs["comments"] has the comments
    above the header, {key: text}, and .attrs["units"] the units of the columns."""
    try:
        table = pandas.read_csv(io.StringIO(text), sep=" ", comment="#", index_col=False)
        missing = [column for column in columns if column not in table]
        if missing:
            fail(f"{name}: has no column {missing[0]}; is it the output of 'trebsweep trace'?")
        if table.isna().to_numpy().any() and not text.endswith("\n"):
            fail(f"{name}: is damaged: not every row has the header's {table.shape[1]} columns")
        table = table.astype(float)
    except ValueError as error:  # of pandas, too
        fail(f"{name}: cannot be read as a table: {error}")
    table = table[np.isfinite(table).all(axis=1)].reset_index(drop=True)
    comments = [line[1:].split("=", 1) for line in text.splitlines() if line.startswith("#") and "=" in line]
    table.attrs = {"comments": {key.strip(): value.strip() for key, value in comments},
                   "units": {column: COLUMNS[column][1] for column in table if column in COLUMNS}}
    return table


def read_file(path: str, columns: tuple[str, ...]) -> pandas.DataFrame:
    """The same of the table at `path`."""
    try:
        with open(path, encoding="utf-8") as file:
            return read_table(file.read(), path, columns)
    except OSError as error:
        return fail(f"{path}: cannot be read: {error.strerror}")
    except UnicodeDecodeError:
        return fail(f"{path}: cannot be read as a table: it is no text")


def read_swing(path: str) -> pandas.DataFrame:
    """The swing at `path`, which has rows."""
    table = read_file(path, SWING)
    return table if len(table) else fail(f"{path}: has no rows of finite numbers")


def read_flight(path: str, swing: pandas.DataFrame) -> pandas.DataFrame | None:
    """The flight after the end of a swing, or None if the table at `path` has no rows."""
    table, end = read_file(path, FLIGHT), swing["t"].iloc[-1]
    if not len(table):
        return None
    if abs(table["t"].iloc[0] - end) > 1e-9 * end:
        fail(f"{path}: is the flight after another swing: it does not start at t = {end:g} s")
    return table


def setting(table: pandas.DataFrame, key: str) -> float | None:
    """A finite number from the comments, or None."""
    try:
        value = float(table.attrs["comments"][key])
    except (KeyError, ValueError):
        return None
    return value if np.isfinite(value) else None


def lift_off(table: pandas.DataFrame) -> tuple[float, float, float] | None:
    """(t, x, y) of the projectile at the lift-off, or None without one."""
    time = setting(table, "lift-off-time")
    if time is None:
        return None
    x, y = (float(np.interp(time, table["t"], table[name])) for name in ("x3", "y3"))
    return time, x, y
