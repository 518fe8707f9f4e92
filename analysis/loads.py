#!/usr/bin/env python3
"""Draws the loads on the best designs of an archive during their swings.

The designs are the local maxima of the speed in the lattice, the fastest first; of several equally
fast neighbours the first counts. Each is traced with the job stored in the archive.

  loads.py accurate.h5                                 -> accurate-loads.png
  loads.py accurate.h5 --count 1 -o loads.svg
"""

import os
import tempfile

from program import Parser, fail, note, refuse, run  # before modules that may be missing

import numpy as np

from archive import Archive, design_text, stem
from launch import PROGRAM_HELP, check, find_program, run_program
from picture import OUTPUT_HELP, check_output, labelled, plt, readable_unit, save, set_title
from trajectory import read_table

PANELS = (("tension", "sling tension at the projectile", "N"),
          ("tip_tension", "sling tension at the arm's tip", "N"),
          ("axle", "force on the axle", "N"),
          ("stress", "bending stress at the fulcrum", "Pa"),
          ("hanger_tension", "tension of the hanger", "N"),
          ("normal", "force of the trough on the projectile", "N"))


def plateau(speed, start):
    """The indices connected to `start` through equally fast neighbours."""
    found, front = {start}, [start]
    while front:
        index = front.pop()
        around = tuple(slice(max(i - 1, 0), i + 2) for i in index)
        first = tuple(part.start for part in around)
        for offset in np.argwhere(speed[around] == speed[index]):
            neighbour = tuple(int(i) for i in first + offset)
            if neighbour not in found:
                found.add(neighbour)
                front.append(neighbour)
    return found


def local_maxima(speed, count):
    """The indices of up to `count` local maxima of a map, fastest first; of a plateau its first."""
    speed = np.nan_to_num(speed, nan=-1.0)
    padded = np.pad(speed, 1, constant_values=-1.0)
    highest = np.full(speed.shape, -1.0)
    for shift in np.ndindex(3, 3, 3):
        window = tuple(slice(s, s + n) for s, n in zip(shift, speed.shape))
        highest = np.maximum(highest, padded[window])
    is_peak = (speed == highest) & (speed > 0)
    peaks = [tuple(int(i) for i in index) for index in np.argwhere(is_peak)]
    maxima, seen = [], set()
    for index in sorted(peaks, key=lambda index: -speed[index]):
        if index in seen:
            continue
        level = plateau(speed, index)
        seen |= level
        if all(is_peak[neighbour] for neighbour in level):  # otherwise it is a ledge
            maxima.append(index)
            if len(maxima) == count:
                break
    return maxima


def trace(archive, design, program, *options):
    """Traces a design: {column: values}; ends the program on failure."""
    with tempfile.TemporaryDirectory() as directory:
        job, table = os.path.join(directory, "job.cfg"), os.path.join(directory, "swing.txt")
        with open(job, "w", encoding="utf-8") as file:
            file.write(archive.attributes["job"])
        lengths = [text for name, value in design.items() for text in (f"--{name}", repr(value))]
        done = run_program(program, "trace", job, *lengths, *options)
        check(done)
        with open(table, "w", encoding="utf-8") as file:
            file.write(done.stdout)
        return read_table(table).rows


def fine_trace(archive, design, program):
    """The same with 500 rows, which resolve the peaks for a machine of any size."""
    seconds = trace(archive, design, program)["t"][-1]
    return trace(archive, design, program, "--interval", repr(float(seconds / 500)))


def draw(archive, designs, program):
    """The figure, with a panel for each load that the machine has."""
    swings = [fine_trace(archive, design, program) for design in designs]
    loads = [panel for panel in PANELS if panel[0] in swings[0]]
    rows = -(-len(loads) // 2)
    figure, panels = plt.subplots(rows, 2, figsize=(13, 4 * rows), sharex=True)
    for axes in panels.flat[len(loads):]:
        axes.set_visible(False)
    for axes, (column, text, unit) in zip(panels.flat, loads):
        factor, unit = readable_unit(unit, max(np.abs(swing[column]).max() for swing in swings))
        for design, swing in zip(designs, swings):
            axes.plot(swing["t"], factor * swing[column],
                      label=f"{design_text(design)}: {swing['speed'][-1]:.4g} m/s")
        axes.set_ylabel(labelled(text, unit))
        axes.axhline(0, color="grey", linewidth=0.6)
    for axes in panels.flat[len(loads) - 2:len(loads)]:
        axes.set_xlabel("time t (s)")
        axes.tick_params(labelbottom=True)
    panels[0, 0].legend(fontsize=8)
    text = f"{archive.name()}: loads of the fastest designs from rest to release"
    set_title(figure, text if archive.complete else f"{text}; {archive.progress()}")
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("archive", metavar="ARCHIVE",
                        help="archive of a sweep with a map of the speed")
    parser.add_scene()
    parser.add_argument("--count", type=int, default=3,
                        help="maximum number of designs to draw, at least 1 (default: 3)")
    parser.add_argument("--program", help=PROGRAM_HELP)
    parser.add_argument("-o", "--output", metavar="PICTURE",
                        help=OUTPUT_HELP + "default: the archive's name with -loads.png")
    arguments = parser.parse_args()

    if arguments.count < 1:
        refuse("count", arguments.count, "must be at least 1")
    output = arguments.output or f"{stem(arguments.archive, arguments.at)}-loads.png"
    check_output(output, arguments.archive)
    archive = Archive(arguments.archive)
    if "speed" not in archive.fields:
        fail(f"{arguments.archive}: has no map of the speed")
    archive = archive.scene(arguments.at)
    program = find_program(arguments.program)
    designs = [archive.design(index)
               for index in local_maxima(archive.read("speed"), arguments.count)]
    if not designs:
        fail(f"{arguments.archive}: has no optimum: {archive.best_text()}")
    save(draw(archive, designs, program), output)
    if len(designs) < arguments.count:
        note(f"{arguments.archive}: only {len(designs)} of {arguments.count} designs drawn: the "
             f"speed has no more local maxima")


if __name__ == "__main__":
    run(main)
