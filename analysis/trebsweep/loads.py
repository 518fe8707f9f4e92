"""Draws the loads on the best designs of an archive during their swings.

The designs are the local maxima of the speed in the lattice, the fastest first; of several equally
fast neighbours the first counts. Each is traced with the job stored in the archive.

  treb-plot loads accurate.h5                                 -> accurate-loads.png
  treb-plot loads accurate.h5 --count 1 -o loads.svg
"""

import numpy as np

from .accessor import design_text, stem
from .api import trace
from .backend import AXES
from .launch import PROGRAM_HELP, find_program
from .picture import COLOURS, add_output, check_output, labelled, readable_unit, save, set_title, with_legend, wrapped
from .program import Parser, fail, note, refuse
from .scenes import load, only
from .swing import COLUMNS

PANELS = ("tension", "tip_tension", "axle", "stress", "hanger_tension", "normal")


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


def fine_trace(archive, design, program):
    """The swing of a design with 500 rows, which resolve the peaks for a machine of any size."""
    seconds = trace(archive.job, **design, program=program)["t"].iloc[-1]
    return trace(archive.job, **design, program=program, interval=seconds / 500)


def draw(archive, designs, program):
    """The figure, with a panel for each load that the machine has."""
    swings = [fine_trace(archive, design, program) for design in designs]
    loads = [column for column in PANELS if column in swings[0]]
    if all(np.allclose(swing["tension"], swing["tip_tension"]) for swing in swings):
        loads.remove("tip_tension")  # of a sling without mass
    rows = -(-len(loads) // 2)
    figure, panels, below = with_legend(0.1 + 0.3 * rows, len(designs), rows, 2, sharex=True)
    for axes in panels.flat[len(loads):]:
        axes.set_visible(False)
    for axes, column in zip(panels.flat, loads):
        text, unit = COLUMNS[column]
        factor, unit = readable_unit(unit, max(np.abs(swing[column]).max() for swing in swings))
        for number, (design, swing) in enumerate(zip(designs, swings)):
            axes.plot(swing["t"], factor * swing[column], color=COLOURS[number % len(COLOURS)],
                      linestyle=("-", "--", "-.", ":")[number % 4],
                      label=f"{design_text(design)}: {swing['speed'].iloc[-1]:.4g} m/s")
        axes.set_ylabel(wrapped(labelled(text, unit), 1.8))
        axes.axhline(0, color="grey", linewidth=0.6)
    for axes in panels.flat[len(loads) - 2:len(loads)]:
        axes.set_xlabel("time t (s)")
        axes.tick_params(labelbottom=True)
    below.legend(*panels[0, 0].get_legend_handles_labels(), loc="center")
    text = f"{archive.name()}: loads of designs that are local maxima of the speed, from rest to release"
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
    add_output(parser, "the archive's name with -loads.png")
    arguments = parser.parse_args()

    if arguments.count < 1:
        refuse("count", arguments.count, "must be at least 1")
    output = arguments.output or f"{stem(arguments.archive, arguments.at)}-loads.png"
    check_output(output, arguments.archive)
    archive = load(arguments.archive)
    if "speed" not in archive.fields:
        fail(f"{arguments.archive}: has no map of the speed")
    archive = only(archive, arguments.at)
    program = find_program(arguments.program)
    designs = [{name: float(archive.data[name][i]) for name, i in zip(AXES, index)}
               for index in local_maxima(archive.data["speed"].values, arguments.count)]
    if not designs:
        fail(f"{arguments.archive}: has no optimum: {archive.best_text()}")
    save(draw(archive, designs, program), output)
    if len(designs) < arguments.count:
        note(f"{arguments.archive}: only {len(designs)} of {arguments.count} designs drawn: the "
             f"speed has no more local maxima")
