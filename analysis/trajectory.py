#!/usr/bin/env python3
"""Draws a swing from the table that `trebsweep trace` prints.

Left: the angles against time (the paper's Figure 2). Right: beam, sling and projectile in equal
intervals of time, with the projectile's path. The format follows the suffix of the picture.
"""

import argparse
import os
import sys

import numpy as np

from archive import plt, save

COLUMNS = ("t", "phi1", "phi2", "x1", "y1", "xt", "yt", "x3", "y3", "speed")


def read_table(path):
    """The table as a structured array; ends the program if it is none."""
    try:
        table = np.atleast_1d(np.genfromtxt(path, names=True))
    except (OSError, ValueError) as error:
        sys.exit(f"{path}: cannot be read as a table: {error}")
    if table.size == 0:
        sys.exit(f"{path}: has no rows")
    missing = [name for name in COLUMNS if name not in (table.dtype.names or ())]
    if missing:
        sys.exit(f"{path}: has no column {missing[0]}; is it a table of 'trebsweep trace'?")
    return table


def draw_angles(axes, table):
    """The angles against time."""
    axes.plot(table["t"], table["phi1"], label=r"$\phi_1$, counterweight's arm")
    axes.plot(table["t"], table["phi2"], "--", label=r"$\phi_2$, sling")
    axes.axhline(np.pi, color="grey", linewidth=0.8)
    axes.annotate(r"$\pi$", (table["t"][0], np.pi), xytext=(2, 3), textcoords="offset points",
                  color="grey")
    axes.set_xlabel("time t (s)")
    axes.set_ylabel("angle (rad)")
    axes.set_title("Angles, clockwise from the vertical")
    axes.legend(loc="center left")


def draw_strobe(axes, table, count):
    """Beam, sling and projectile at `count` equally spaced times, and the projectile's path."""
    times = np.linspace(table["t"][0], table["t"][-1], count)
    rows = sorted({int(np.argmin(np.abs(table["t"] - time))) for time in times})
    colours = plt.get_cmap("viridis")
    for i in rows:
        row = table[i]
        share = (row["t"] - table["t"][0]) / (table["t"][-1] - table["t"][0] or 1)
        colour = colours(0.9 * share)
        axes.plot([row["x1"], row["xt"]], [row["y1"], row["yt"]], color=colour, linewidth=2)
        axes.plot([row["xt"], row["x3"]], [row["yt"], row["y3"]], color=colour, linewidth=0.8)
        axes.plot(row["x1"], row["y1"], "s", color=colour, markersize=7)
        axes.plot(row["x3"], row["y3"], "o", color=colour, markersize=4)
    axes.plot(table["x3"], table["y3"], color="red", linewidth=0.8, label="projectile")
    axes.plot(0, 0, "k^", markersize=7, label="fulcrum")
    last = table[-1]
    axes.set_title(f"t = {table['t'][0]:g} to {last['t']:.4g} s, {last['speed']:.5g} m/s at the end")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y, upward from the fulcrum (m)")
    axes.set_aspect("equal", adjustable="datalim")
    scale = plt.cm.ScalarMappable(plt.Normalize(table["t"][0], last["t"]), colours)
    axes.figure.colorbar(scale, ax=axes, label="time (s)")
    axes.legend(loc="upper left")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", help="what 'trebsweep trace' printed")
    parser.add_argument("--count", type=int, default=16, help="positions drawn (default: 16)")
    parser.add_argument("-o", "--output", metavar="PICTURE",
                        help="default: the table's name with .png")
    arguments = parser.parse_args()

    if arguments.count < 2:
        sys.exit(f"count = {arguments.count}: must be at least 2")
    table = read_table(arguments.table)
    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 5.5), constrained_layout=True)
    draw_angles(left, table)
    draw_strobe(right, table, arguments.count)
    save(figure, arguments.output or os.path.splitext(arguments.table)[0] + ".png")


if __name__ == "__main__":
    main()
