#!/usr/bin/env python3
"""Draws a swing from the table that `trebsweep trace` prints.

Upper left: the angles against time (the paper's Figure 2). Upper right: beam, sling and projectile
at equal intervals of time, with the projectile's path and the ground. Below, if the projectile was
released: its free flight in vacuum to the ground.

The ground and the flight need the comments above the table's header (`# fulcrum-height = 1.5`,
`# gravity = 9.8`, ...); without them neither is drawn.

  trebsweep trace jobs/accurate.cfg --r1 0.51 --r2 0.91 --r3 0.58 > swing.txt
  trajectory.py swing.txt                              -> swing.png
"""

import os
from collections import namedtuple

from program import Parser, fail, refuse, run  # before modules that may be missing

import numpy as np

from picture import OUTPUT_HELP, check_output, plt, save

COLUMNS = ("t", "phi1", "phi2", "w1", "w2", "x1", "y1", "xt", "yt", "x3", "y3", "speed")

# The rows of a table {column: values}, and the comments above its header {key: value}.
Table = namedtuple("Table", "rows comments")


def read_table(path):
    """Reads the table at `path`; ends the program if it is not one."""
    if os.path.exists(path) and not os.path.isfile(path):
        fail(f"{path}: is not a regular file")
    try:
        with open(path, encoding="utf-8") as file:
            lines = file.read().splitlines()
        header, *rows = [line.split() for line in lines
                         if line and not line.startswith("#")] or [[]]
        missing = [name for name in COLUMNS if name not in header]
        if missing:
            fail(f"{path}: has no column {missing[0]}; is it the output of 'trebsweep trace'?")
        if any(len(row) != len(header) for row in rows):
            fail(f"{path}: is damaged: not every row has the header's {len(header)} columns")
        values = np.array([[float(text) for text in row] for row in rows])
    except OSError as error:
        fail(f"{path}: cannot be read: {error.strerror}")
    except ValueError as error:
        fail(f"{path}: cannot be read as a table: {error}")
    values = values[np.isfinite(values).all(axis=1)] if rows else values
    if not values.size:
        fail(f"{path}: has no rows of finite numbers")
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


def last_row(table):
    """{column: value} of the last row."""
    return {name: values[-1] for name, values in table.rows.items()}


def released(table):
    """Whether the table ends with a release: phi1 is pi or, by the job's release rule, near it."""
    is_window = table.comments.get("release") == "window"
    allowed = setting(table, "release-window") if is_window else 1e-6
    return allowed is not None and abs(table.rows["phi1"][-1] - np.pi) <= allowed


def last_velocity(table):
    """The projectile's velocity in the last row, (vx, vy) in m/s, from the rates of the angles. The
    rate at which an elastic sling stretches follows from the speed."""
    end = last_row(table)
    arm = np.hypot(end["xt"], end["yt"])
    sling = np.hypot(table.rows["x3"] - table.rows["xt"], table.rows["y3"] - table.rows["yt"])
    velocity = np.array([-arm * end["w1"] * np.cos(end["phi1"])
                         - sling[-1] * end["w2"] * np.cos(end["phi2"]),
                         arm * end["w1"] * np.sin(end["phi1"])
                         + sling[-1] * end["w2"] * np.sin(end["phi2"])])
    direction = np.array([end["x3"] - end["xt"], end["y3"] - end["yt"]]) / sling[-1]
    times, rows = np.unique(table.rows["t"], return_index=True)
    if len(times) < 2 or np.ptp(sling) <= 1e-6 * sling[-1]:
        return velocity
    # |velocity + rate direction| = speed has two solutions: take the one nearer to the last rows.
    measured = np.gradient(sling[rows], times)[-1]
    along = velocity @ direction
    root = np.sqrt(max(along**2 - velocity @ velocity + end["speed"] ** 2, 0))
    return velocity + min(-along - root, -along + root, key=lambda x: abs(x - measured)) * direction


def flight(table):
    """The free flight from release to ground, arrays (x, y) in m, or None without a flight."""
    height, gravity = setting(table, "fulcrum-height"), setting(table, "gravity")
    if height is None or not gravity or gravity <= 0 or not released(table):
        return None
    x, y = table.rows["x3"][-1], table.rows["y3"][-1]
    if y + height < 0:
        return None
    vx, vy = last_velocity(table)
    time = np.linspace(0, (vy + np.sqrt(vy**2 + 2 * gravity * (y + height))) / gravity, 200)
    return x + vx * time, y + vy * time - gravity * time**2 / 2


def draw_angles(axes, rows):
    """Draws the angles against time."""
    axes.plot(rows["t"], rows["phi1"], label=r"$\phi_1$, counterweight arm")
    axes.plot(rows["t"], rows["phi2"], "--", label=r"$\phi_2$, sling")
    axes.axhline(np.pi, color="grey", linewidth=0.8)
    axes.annotate(r"$\pi$", (rows["t"][0], np.pi), xytext=(2, 3), textcoords="offset points",
                  color="grey")
    axes.set_xlabel("time t (s)")
    axes.set_ylabel("angle (rad)")
    axes.set_title("Angles, clockwise from the vertical")
    axes.legend(loc="best")


def draw_ground(axes, table):
    """Draws the ground, if its height is known."""
    height = setting(table, "fulcrum-height")
    if height is not None:
        axes.axhline(-height, color="saddlebrown", linewidth=1.5, label="ground")


def draw_path(axes, table, path):
    """Draws the projectile's path before and after the release."""
    axes.plot(table.rows["x3"], table.rows["y3"], color="red", linewidth=0.8, label="projectile")
    if path is not None:
        axes.plot(*path, ":", color="red", linewidth=1.2, label="free flight")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y, upward from the fulcrum (m)")


def draw_strobe(axes, table, count, path):
    """Draws beam, sling and projectile at `count` equally spaced times, and the path."""
    rows = table.rows
    start, end = rows["t"][0], rows["t"][-1]
    length = end - start or 1
    chosen = sorted({int(np.argmin(np.abs(rows["t"] - time)))
                     for time in np.linspace(start, end, count)})
    colours = plt.get_cmap("viridis")
    for i in chosen:
        colour = colours(0.9 * (rows["t"][i] - start) / length)
        axes.plot([rows["x1"][i], rows["xt"][i]], [rows["y1"][i], rows["yt"][i]], color=colour,
                  linewidth=2)
        axes.plot([rows["xt"][i], rows["x3"][i]], [rows["yt"][i], rows["y3"][i]], color=colour,
                  linewidth=0.8)
        axes.plot(rows["x1"][i], rows["y1"][i], "s", color=colour, markersize=7)
        axes.plot(rows["x3"][i], rows["y3"][i], "o", color=colour, markersize=4)
    axes.plot(0, 0, "k^", markersize=7, label="fulcrum")
    draw_ground(axes, table)
    draw_path(axes, table, None)
    limits = axes.axis()
    if path is not None:
        axes.plot(*path, ":", color="red", linewidth=1.2, label="free flight")
    axes.axis(limits)  # without the flight, which is much longer
    axes.set_title(f"t = {start:g} to {end:.4g} s, {rows['speed'][-1]:.5g} m/s at the end")
    axes.set_aspect("equal", adjustable="datalim")
    scale = plt.cm.ScalarMappable(plt.Normalize(start, start + length), colours)
    axes.figure.colorbar(scale, ax=axes, label="time (s)")
    axes.legend(loc="best", fontsize=9)


def draw_flight(axes, table, path):
    """Draws the projectile's path to the ground."""
    draw_ground(axes, table)
    draw_path(axes, table, path)
    axes.plot(0, 0, "k^", markersize=7, label="fulcrum")
    x, y = path
    axes.set_title(f"Free flight in vacuum: {abs(x[-1] - x[0]):.4g} m from the release to the "
                   f"ground, up to {y.max() - y[-1]:.4g} m above it")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="best", fontsize=9)


def draw(table, count):
    """The figure of a swing."""
    path = flight(table)
    if path is None:
        figure, panels = plt.subplot_mosaic([["angles", "strobe"]], figsize=(13, 5.5))
    else:
        figure, panels = plt.subplot_mosaic([["angles", "strobe"], ["flight", "flight"]],
                                            figsize=(13, 9), gridspec_kw={"height_ratios": (3, 2)})
        draw_flight(panels["flight"], table, path)
    draw_angles(panels["angles"], table.rows)
    draw_strobe(panels["strobe"], table, count, path)
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("table", metavar="TABLE", help="output of 'trebsweep trace'")
    parser.add_argument("--count", type=int, default=16,
                        help="number of positions to draw, at least 2 (default: 16)")
    parser.add_argument("-o", "--output", metavar="PICTURE",
                        help=OUTPUT_HELP + "default: the table's name with .png")
    arguments = parser.parse_args()

    if arguments.count < 2:
        refuse("count", arguments.count, "must be at least 2")
    output = arguments.output or os.path.splitext(arguments.table)[0] + ".png"
    check_output(output, arguments.table)
    save(draw(read_table(arguments.table), arguments.count), output)


if __name__ == "__main__":
    run(main)
