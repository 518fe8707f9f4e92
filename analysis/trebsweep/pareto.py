"""Draws a Pareto front: of trebsweep optimum --pareto, or of two fields among the designs of an archive.

Of the output of `trebsweep optimum JOB --pareto "A, B" --json`, each point is the largest A of all
designs with at least its B. The text at a point is its multiplier, how much A one unit of B costs
there. Hollow points are the best that can be built safely, next to better ones that cannot.

Of an archive, --field gives two fields or expressions, both as large as possible. Grey are all designs
of all scenes, in up to 20,000 samples; the designs of the front, which no other beats in both, are
printed as a table.

  trebsweep optimum jobs/backyard.cfg --pareto "range, -peak-axle-load" 20 --json > front.json
  treb-plot pareto front.json -o front.png
  treb-plot pareto loads.h5 --field "speed, -peak_axle_load" --among "slack == 1"
"""

import json
import os

import numpy as np

from .expressions import Expression
from .picture import COLOURS, add_output, check_output, labelled, plt, readable_unit, save, set_title, size
from .program import Parser, existing, fail, is_hdf5, refuse
from .scenes import load, select

SAMPLES = 20000  # of the designs that are drawn


def read_front(path):
    """The object of a front's JSON."""
    try:
        with open(path, encoding="utf-8") as file:
            front = json.load(file)
    except (OSError, ValueError) as error:
        fail(f"{path}: cannot be read: {error}")
    if not isinstance(front, dict) or not front.get("points") or "objectives" not in front:
        refuse("front", path, "must be the output of trebsweep optimum --pareto --json")
    return front


def axis_scale(name, unit, values):
    """The factor of an objective's values, and the label of its axis with their unit."""
    factor, unit = readable_unit(unit, max(map(abs, values)))
    return factor, labelled(name, unit), unit


def draw(front, name):
    """The figure: the first objective against the second one."""
    figure, axes = plt.subplots(figsize=size(0.6))
    values = np.array([point["values"] for point in front["points"]])
    scales = [axis_scale(*column) for column in zip(front["objectives"], front["units"], values.T)]
    y, x = (factor * column for (factor, _, _), column in zip(scales, values.T))
    units = " per ".join(unit for _, _, unit in scales if unit)
    axes.plot(x, y, color=COLOURS[0], zorder=1, label=f"numbers: multiplier, {units}")
    for a, b, point in zip(x, y, front["points"]):
        axes.plot(a, b, "o", color=COLOURS[0], markerfacecolor=COLOURS[0] if point["safe"] else "white")
    for i in range(1, len(x) - 1, max(1, len(x) // 6)):
        multiplier = front["points"][i]["multiplier"]
        if multiplier is not None:
            axes.annotate(f"{multiplier * scales[0][0] / scales[1][0]:.3g}", (x[i], y[i]), xytext=(6, 6),
                          textcoords="offset points")
    finish(figure, axes, scales, f"{name}: Pareto front of {' and '.join(front['objectives'])}")
    return figure


def finish(figure, axes, scales, title):
    """Labels the axes, the first objective upward, and the figure."""
    axes.set_ylabel(scales[0][1])
    axes.set_xlabel(scales[1][1])
    axes.grid(color="0.9")
    axes.legend(loc="best")
    set_title(figure, title)


def sample(archive, fields, among, every=False):
    """The values of expressions of some designs of all scenes, or of all, (field, design)."""
    expressions, condition = [Expression("field", text) for text in fields], among and Expression("among", among)
    found = []
    for part in archive.blocks():
        values = np.array([expression.values(part).ravel() for expression in expressions])
        good = np.isfinite(values).all(axis=0)
        found.append(values[:, good & condition.flags(part).ravel() if condition else good])
    values = np.hstack(found)
    return values if every else values[:, ::-(-max(values.shape[1], 1) // SAMPLES)]


def draw_designs(archive, fields, among, front):
    """The figure of all designs and of the front, a table."""
    figure, axes = plt.subplots(figsize=size(0.6))
    shown = sample(archive, fields, among)
    units = [archive.unit(text.lstrip("-")) if text.lstrip("-") in archive.fields else "" for text in fields]
    scales = [axis_scale(*column) for column in zip(fields, units, shown)]
    y, x = (factor * column for (factor, _, _), column in zip(scales, shown))
    axes.plot(x, y, ".", color="0.75", markersize=2, rasterized=True, label="designs")
    y, x = (factor * front[text] for (factor, _, _), text in zip(scales, fields))
    axes.plot(x, y, "o-", color=COLOURS[0], markersize=4, drawstyle="steps-post", label="front")
    progress = "" if archive.complete else f"; {archive.progress()}"
    finish(figure, axes, scales, f"{archive.name()}: front of {' and '.join(fields)}{progress}")
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("front", metavar="FRONT", help="JSON of trebsweep optimum --pareto, or an archive")
    parser.add_argument("--field", metavar="A,B", help="of an archive: two fields or expressions")
    parser.add_argument("--among", metavar="EXPRESSION", help="of an archive: true of the designs to consider")
    parser.add_scene(what="of an archive, use only the scenes with this value")
    add_output(parser, "FRONT.png")
    arguments = parser.parse_args()
    name = os.path.splitext(os.path.basename(arguments.front))[0]
    output = arguments.output or f"{name}.png"
    check_output(output, arguments.front)
    if not is_hdf5(existing(arguments.front)) and not existing(arguments.front).endswith(".partial"):
        save(draw(read_front(arguments.front), name), output)
        return
    fields = [text.strip() for text in (arguments.field or "").split(",")]
    if len(fields) != 2:
        refuse("field", arguments.field, "must be two fields or expressions, such as \"range, -peak_axle_load\"")
    archive = select(load(arguments.front), arguments.at)
    fields = [Expression("field", text).joined(archive.fields) for text in fields]
    front = archive.pareto(*fields, where=arguments.among)
    if front.empty:
        fail(f"{archive.path}: no design has both fields")
    print(front.to_string(index=False, float_format="{:.7g}".format))
    save(draw_designs(archive, fields, arguments.among, front), output)
