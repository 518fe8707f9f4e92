#!/usr/bin/env python3
"""Draws a Pareto front, the output of `trebsweep optimum JOB --pareto "A, B" --json`.

Each point is the largest A of all designs with at least its B. The text at a point is its multiplier,
how much A one unit of B costs there. Hollow points are the best that can be built safely, next to
better ones that cannot.

  trebsweep optimum jobs/backyard.cfg --pareto "range, -peak-axle-load" 20 --json > front.json
  pareto.py front.json -o front.png
"""

import json
import os

from program import Parser, fail, refuse, run  # before modules that may be missing

from picture import FORMATS, check_output, labelled, plt, readable_unit, save, set_title


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


def draw(front, name):
    """The figure: the first objective against the second one."""
    figure, axes = plt.subplots(figsize=(8, 5))
    values = [point["values"] for point in front["points"]]
    factors, labels, units = [], [], []
    for i, (objective, unit) in enumerate(zip(front["objectives"], front["units"])):
        factor, text = readable_unit(unit, max(abs(pair[i]) for pair in values))
        factors.append(factor)
        labels.append(labelled(objective, text))
        units.append(text)
    y, x = ([factors[i] * pair[i] for pair in values] for i in (0, 1))
    axes.plot(x, y, color="tab:blue", zorder=1, label="numbers: multiplier" + f", {' per '.join(filter(None, units))}")
    for a, b, point in zip(x, y, front["points"]):
        axes.plot(a, b, "o", color="tab:blue", markerfacecolor="tab:blue" if point["safe"] else "white")
    for i in range(1, len(x) - 1, max(1, len(x) // 6)):
        multiplier = front["points"][i]["multiplier"]
        if multiplier is not None:
            axes.annotate(f"{multiplier * factors[0] / factors[1]:.3g}", (x[i], y[i]), xytext=(6, 6),
                          textcoords="offset points", fontsize="small")
    axes.set_ylabel(labels[0])
    axes.set_xlabel(labels[1])
    axes.grid(color="0.9")
    axes.legend(loc="best")
    set_title(figure, f"{name}: Pareto front of {front['objectives'][0]} and {front['objectives'][1]}")
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("front", metavar="FRONT", help="JSON of trebsweep optimum --pareto")
    parser.add_argument("-o", "--output", metavar="FILE",
                        help=f"the suffix selects the format ({', '.join(FORMATS)}); default: FRONT.png")
    arguments = parser.parse_args()
    name = os.path.splitext(os.path.basename(arguments.front))[0]
    output = arguments.output or f"{name}.png"
    check_output(output, arguments.front)
    save(draw(read_front(arguments.front), name), output)


if __name__ == "__main__":
    run(main)
