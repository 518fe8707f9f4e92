#!/usr/bin/env python3
"""Draws a swing, and its flight, from the tables that `trebsweep trace` prints.

Upper left: the angles against time (the paper's Figure 2). Upper right: beam, sling, projectile
and, if it has one, the counterweight's hanger at equal intervals of time, with the projectile's
path, the trough and the ground. Below, with --flight: the projectile's path to the ground.

Ground, trough and lift-off need the comments above the table's header (`# fulcrum-height = 1.5`,
`# lift-off-time = 0.25`, ...); without them they are not drawn.

  trebsweep trace jobs/accurate.cfg --r1 0.51 --r2 0.91 --r3 0.58 > swing.txt
  trebsweep trace jobs/accurate.cfg --r1 0.51 --r2 0.91 --r3 0.58 --flight > flight.txt
  trajectory.py swing.txt --flight flight.txt          -> swing.png
"""

import os
from collections import namedtuple

from program import Parser, fail, refuse, run  # before modules that may be missing

import numpy as np

from picture import OUTPUT_HELP, check_output, plt, save

COLUMNS = ("t", "phi1", "phi2", "x1", "y1", "xt", "yt", "x3", "y3", "speed")
FLIGHT_COLUMNS = ("t", "x3", "y3", "speed")

# The rows of a table {column: values}, and the comments above its header {key: value}.
Table = namedtuple("Table", "rows comments")


def read_table(path, columns=COLUMNS):
    """Reads the table with the given columns at `path`; ends the program if it is not one, or has
    no rows."""
    table = read_rows(path, columns)
    if not table.rows[columns[0]].size:
        fail(f"{path}: has no rows of finite numbers")
    return table


def read_flight(path, swing):
    """Reads the flight after the end of a swing, or None if the table at `path` has no rows."""
    table = read_rows(path, FLIGHT_COLUMNS)
    if not table.rows["t"].size:
        return None
    end = swing.rows["t"][-1]
    if abs(table.rows["t"][0] - end) > 1e-9 * end:
        fail(f"{path}: is the flight after another swing: it does not start at t = {end:g} s")
    return table


def read_rows(path, columns):
    """Reads a table that may be without rows."""
    if os.path.exists(path) and not os.path.isfile(path):
        fail(f"{path}: is not a regular file")
    try:
        with open(path, encoding="utf-8") as file:
            lines = file.read().splitlines()
        header, *rows = [line.split() for line in lines
                         if line and not line.startswith("#")] or [[]]
        missing = [name for name in columns if name not in header]
        if missing:
            fail(f"{path}: has no column {missing[0]}; is it the output of 'trebsweep trace'?")
        if any(len(row) != len(header) for row in rows):
            fail(f"{path}: is damaged: not every row has the header's {len(header)} columns")
        values = np.array([[float(text) for text in row] for row in rows]).reshape(-1, len(header))
    except OSError as error:
        fail(f"{path}: cannot be read: {error.strerror}")
    except ValueError as error:
        fail(f"{path}: cannot be read as a table: {error}")
    values = values[np.isfinite(values).all(axis=1)]
    comments = [line[1:].split("=", 1) for line in lines if line.startswith("#") and "=" in line]
    return Table(dict(zip(header, values.T)),
                 {key.strip(): value.strip() for key, value in comments})


def setting(table, key):
    """A finite number from the comments, or None."""
    try:
        value = float(table.comments[key])
    except (KeyError, ValueError):
        return None
    return value if np.isfinite(value) else None


def lift_off(table):
    """(t, x, y) of the projectile at the lift-off, or None without one."""
    time, rows = setting(table, "lift-off-time"), table.rows
    if time is None:
        return None
    return time, np.interp(time, rows["t"], rows["x3"]), np.interp(time, rows["t"], rows["y3"])


def draw_angles(axes, table):
    """Draws the angles against time, and the time of the lift-off."""
    rows = table.rows
    axes.plot(rows["t"], rows["phi1"], label=r"$\phi_1$, counterweight arm")
    axes.plot(rows["t"], rows["phi2"], "--", label=r"$\phi_2$, sling")
    if "phi3" in rows:
        axes.plot(rows["t"], rows["phi3"], "-.", label=r"$\phi_3$, hanger")
    axes.axhline(np.pi, color="grey", linewidth=0.8)
    axes.annotate(r"$\pi$", (rows["t"][0], np.pi), xytext=(2, 3), textcoords="offset points",
                  color="grey")
    if lift_off(table):
        axes.axvline(lift_off(table)[0], color="grey", linewidth=0.8, linestyle=":",
                     label="lift-off")
    axes.set_xlabel("time t (s)")
    axes.set_ylabel("angle (rad)")
    axes.margins(y=0.08)
    axes.set_title("Angles, clockwise from the vertical")
    axes.legend(loc="best")


def draw_surroundings(axes, table):
    """Draws the fulcrum, the ground, if its height is known, and the labels of the axes."""
    axes.plot(0, 0, "k^", markersize=7, label="fulcrum")
    height = setting(table, "fulcrum-height")
    if height is not None:
        axes.axhline(-height, color="saddlebrown", linewidth=1.5, label="ground")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y, upward from the fulcrum (m)")


def draw_trough(axes, table):
    """Draws the trough, in which the projectile slides up to the lift-off, or to the end."""
    if setting(table, "trough-height") is None:
        return
    x, y = table.rows["x3"], table.rows["y3"]
    end = lift_off(table)
    slid = x if end is None else [*x[table.rows["t"] < end[0]], end[1]]
    axes.plot([min(slid), max(slid)], [y[0], y[0]], color="burlywood", linewidth=9,
              solid_capstyle="butt", label="trough", zorder=1.5)
    if end is not None:
        axes.plot(*end[1:], "D", color="white", markeredgecolor="red", markersize=6,
                  label="lift-off", zorder=3)


def draw_machine(axes, rows, i, colour):
    """Draws beam, hanger, sling, counterweight and projectile of a row."""
    hinge = ("xh", "yh") if "xh" in rows else ("x1", "y1")
    for first, second, width in ((hinge, ("xt", "yt"), 2), (hinge, ("x1", "y1"), 1.2),
                                 (("xt", "yt"), ("x3", "y3"), 0.8)):
        axes.plot(*([rows[name][i] for name in names] for names in zip(first, second)),
                  color=colour, linewidth=width)
    axes.plot(rows["x1"][i], rows["y1"][i], "s", color=colour, markersize=7)
    axes.plot(rows["x3"][i], rows["y3"][i], "o", color=colour, markersize=4)


def draw_strobe(axes, table, count, flight):
    """Draws the machine at `count` equally spaced times, and the path."""
    rows = table.rows
    start, end = rows["t"][0], rows["t"][-1]
    length = end - start or 1
    chosen = sorted({int(np.argmin(np.abs(rows["t"] - time)))
                     for time in np.linspace(start, end, count)})
    colours = plt.get_cmap("viridis")
    for i in chosen:
        draw_machine(axes, rows, i, colours(0.9 * (rows["t"][i] - start) / length))
    draw_surroundings(axes, table)
    draw_trough(axes, table)
    axes.plot(rows["x3"], rows["y3"], color="red", linewidth=0.8, label="projectile")
    if flight:
        limits = axes.axis()
        axes.plot(flight.rows["x3"], flight.rows["y3"], ":", color="red", linewidth=1.2,
                  label="flight")
        axes.axis(limits)  # without the flight, which is much longer
    moment = "release" if setting(table, "release-time") is not None else "end"
    axes.set_title(f"t = {start:g} to {end:.4g} s, {rows['speed'][-1]:.5g} m/s at the {moment}")
    axes.set_aspect("equal", adjustable="datalim")
    scale = plt.cm.ScalarMappable(plt.Normalize(start, start + length), colours)
    axes.figure.colorbar(scale, ax=axes, label="time (s)")
    axes.legend(loc="best", fontsize=9)


def draw_flight(axes, table, flight):
    """Draws the projectile's path to the ground."""
    draw_surroundings(axes, table)
    axes.plot(table.rows["x3"], table.rows["y3"], color="red", linewidth=0.8, label="projectile")
    t, x, y, speed = (flight.rows[name] for name in FLIGHT_COLUMNS)
    axes.plot(x, y, ":", color="red", linewidth=1.2, label="flight")
    axes.plot(x[-1], y[-1], "x", color="red", label="impact")
    axes.set_title(f"Flight: range {x[-1]:.4g} m from the foot of the fulcrum, up to "
                   f"{y.max() - y[-1]:.4g} m above the ground; impact after {t[-1] - t[0]:.3g} s "
                   f"at {speed[-1]:.4g} m/s")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="best", fontsize=9)


def draw(table, count, flight=None):
    """The figure of a swing, and of its flight if it has one."""
    if not flight:
        figure, panels = plt.subplot_mosaic([["angles", "strobe"]], figsize=(13, 5.5))
    else:
        figure, panels = plt.subplot_mosaic([["angles", "strobe"], ["flight", "flight"]],
                                            figsize=(13, 9), gridspec_kw={"height_ratios": (3, 2)})
        draw_flight(panels["flight"], table, flight)
    draw_angles(panels["angles"], table)
    draw_strobe(panels["strobe"], table, count, flight)
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("table", metavar="TABLE", help="output of 'trebsweep trace'")
    parser.add_argument("--count", type=int, default=16,
                        help="number of positions to draw, at least 2 (default: 16)")
    parser.add_argument("--flight", metavar="TABLE",
                        help="output of 'trebsweep trace --flight' for the same swing")
    parser.add_argument("-o", "--output", metavar="PICTURE",
                        help=OUTPUT_HELP + "default: the table's name with .png")
    arguments = parser.parse_args()

    if arguments.count < 2:
        refuse("count", arguments.count, "must be at least 2")
    output = arguments.output or os.path.splitext(arguments.table)[0] + ".png"
    tables = [name for name in (arguments.table, arguments.flight) if name]
    check_output(output, *tables)
    table = read_table(arguments.table)
    flight = arguments.flight and read_flight(arguments.flight, table)
    save(draw(table, arguments.count, flight), output)


if __name__ == "__main__":
    run(main)
