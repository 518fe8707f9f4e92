#!/usr/bin/env python3
"""Draws the loads of the best designs of an archive along their swings.

The designs are the fastest that are local maxima of the speed map, so that neighbours do not crowd
out the rest; each is traced anew with the archive's own job. The format follows the suffix of the
picture.
"""

import argparse
import os
import subprocess
import sys
import tempfile

import numpy as np

from archive import AXES, Archive, plt, save
from trajectory import read_table

PROGRAM = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "build",
                       "release", "trebsweep")
PANELS = (("tension", "pull of the sling on the projectile (kN)", 1e-3),
          ("tip_tension", "pull of the sling on the arm's tip (kN)", 1e-3),
          ("axle", "force on the axle (kN)", 1e-3),
          ("stress", "bending stress at the fulcrum (MPa)", 1e-6))


def best_designs(archive, count):
    """The places of the fastest designs that no neighbour outdoes, fastest first."""
    speed = np.nan_to_num(archive.map("speed")[...], nan=-1.0)
    padded = np.pad(speed, 1, constant_values=-1.0)
    highest = np.full(speed.shape, -1.0)
    for shift in np.ndindex(3, 3, 3):
        window = tuple(slice(s, s + n) for s, n in zip(shift, speed.shape))
        highest = np.maximum(highest, padded[window])
    peaks = np.argwhere((speed == highest) & (speed > 0))
    order = np.argsort([-speed[tuple(peak)] for peak in peaks], kind="stable")
    return [dict(zip(AXES, place)) for place in peaks[order][:count]]


def trace(archive, design, program):
    """The table of a design's swing."""
    with tempfile.TemporaryDirectory() as folder:
        job, table = os.path.join(folder, "job.cfg"), os.path.join(folder, "swing.txt")
        with open(job, "w", encoding="utf-8") as file:
            file.write(archive.attribute("job"))
        lengths = [text for name, value in design.items() for text in (f"--{name}", f"{value!r}")]
        with open(table, "w", encoding="utf-8") as file:
            subprocess.run([program, "trace", job, *lengths, "--interval", "0.002"], check=True,
                           stdout=file)
        return read_table(table)


def draw(archive, count, program):
    """The figure, a panel for each load."""
    figure, panels = plt.subplots(2, 2, figsize=(13, 8), sharex=True, constrained_layout=True)
    for place in best_designs(archive, count):
        design = {name: float(archive.axes[name][i]) for name, i in place.items()}
        table = trace(archive, design, program)
        label = ", ".join(f"{name} = {value:g}" for name, value in design.items())
        for axes, (column, _, unit) in zip(panels.flat, PANELS):
            axes.plot(table["t"], unit * table[column],
                      label=f"{label} m: {table['speed'][-1]:.4g} m/s")
    for axes, (_, label, _) in zip(panels.flat, PANELS):
        axes.set_ylabel(label)
        axes.axhline(0, color="grey", linewidth=0.6)
    for axes in panels[1]:
        axes.set_xlabel("time t (s)")
    panels[0, 0].legend(fontsize=8)
    name = os.path.splitext(os.path.basename(archive.path))[0]
    figure.suptitle(f"{name}: loads of the fastest designs from rest to release")
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("archive", help="archive of a sweep")
    parser.add_argument("--count", type=int, default=3, help="designs drawn (default: 3)")
    parser.add_argument("--program", default=PROGRAM, help="the program (default: build/release's)")
    parser.add_argument("-o", "--output", metavar="PICTURE",
                        help="default: the archive's name with -loads.png")
    arguments = parser.parse_args()
    if arguments.count < 1:
        sys.exit(f"count = {arguments.count}: must be at least 1")
    archive = Archive(arguments.archive)
    if "speed" not in archive.fields:
        sys.exit(f"{arguments.archive}: has no map of the speed")
    output = arguments.output or f"{os.path.splitext(arguments.archive)[0]}-loads.png"
    save(draw(archive, arguments.count, arguments.program), output)


if __name__ == "__main__":
    main()
