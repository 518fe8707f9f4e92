"""Draws the neighbourhood of a job's optimum: the objective against r1, r2 and r3.

In each panel the other two lengths are those of the optimum that `trebsweep optimum` finds. The
panel extends a few times as far as the length may be off before 1 % of the objective is lost, but
hardly beyond the bounds of the lattice. Its title also says where a bound or a constraint allows
less. The curve has gaps where a design has no release. Regions that violate a constraint are
shaded. With optimum.deviation, a band shows the deviation of the length, and lines show the worst
and the expected objective.

All designs are integrated accurately, whatever the job's stepper. Options of `trebsweep optimum`
follow after --.

  treb-plot neighbourhood jobs/accurate.cfg                   -> accurate-neighbourhood.png
  treb-plot neighbourhood jobs/lab.cfg -o lab.svg -- --optimum.objective range
"""

import os
import re
import sys
import tempfile
from collections import namedtuple

import numpy as np
from matplotlib.ticker import MaxNLocator

from .backend import AXES
from .job import accurate_job, job_text, parse_job, without_sections
from .launch import PROGRAM_HELP, checked, command, find_program, parse_optimum, run_program
from .picture import COLOURS, add_output, check_output, labelled, readable_unit, save, set_title, with_legend, wrapped
from .program import Parser, refuse
from .scenes import load, only

PANELS = ("r1", "r2", "r3")
DESIGNS = 200   # of a curve
REACH = 3       # of a panel, in lengths that lose 1 %
LEAST = 0.02    # reach of a panel beyond a limit, at least, in lengths
BEYOND = 0.05   # of a panel, beyond the bounds of the lattice
HEIGHT = 0.1    # of a panel above the optimum, and below it and the worst value, at most, in values
WORDS = {"no": "optimum", "worst": "best worst case", "expected": "best expected value"}

# A constraint is violated where sign * (field - limit) > 0; `field` is None if it is on a formula,
# which is not drawn.
Constraint = namedtuple("Constraint", "text field sign limit")

# A length of the optimum, its bounds, how much shorter and longer it may be (inf: any length), m,
# and what ends this: a limit as text, or None for the loss of 1 % of the objective.
Length = namedtuple("Length", "value bounds shorter longer shorter_limit longer_limit")

# What `trebsweep optimum` found for a job {(section, key): value}: its lengths {name: Length}; the
# job's constraints, and those of a machine that can be built; the worst and the expected value
# under the deviation, None without one or if designs in it have no release.
Optimum = namedtuple("Optimum", "job objective value lengths given_constraints build_constraints "
                     "deviation worst expected")


def read_constraint(text, fields):
    """The Constraint of a text such as "range >= 80", where `fields` are those that constraints need."""
    expression, relation, limit = text.rsplit(" ", 2)
    return Constraint(text, expression if expression in fields else None, 1 if relation == "<=" else -1,
                      float(limit))


def read_optimum(result):
    """The Optimum that an object of `trebsweep optimum --json` describes."""
    job = parse_job(result["job"])
    if not re.fullmatch("[a-z]+(-[a-z]+)*", result["objective"]):
        refuse("optimum.objective", result["objective"], "must be a field: the maps of a sweep hold no formulas")
    lengths = {name: Length(result[name], bounds, *(np.inf if loss is None else loss
                                                    for loss in losses), *limits)
               for name, bounds, losses, limits in zip(
                   AXES, result["bounds"], result["one_percent_loss"], result["one_percent_limit"])}
    return Optimum(job, result["objective"], result["value"], lengths,
                   [read_constraint(text, result["units"]) for text in result["constraints"]],
                   [read_constraint(text, result["units"]) for text in result["build_constraints"]],
                   float(job["optimum", "deviation"]), result["worst"], result["expected"])


def field_constraints(optimum):
    """The constraints on fields that the search had."""
    return [c for c in optimum.given_constraints + optimum.build_constraints if c.field]


def is_free(length):
    """Whether a length was varied in the search."""
    return length.bounds[0] < length.bounds[1]


def extent(length, deviation):
    """The ends of a panel, m."""
    half = 0.5 * length.value  # the program looks no farther for a loss of 1 %
    beyond_limit = max(REACH * max(length.shorter, length.longer), LEAST * length.value)
    below, above = (min(half, beyond_limit if limit else REACH * loss) for loss, limit in (
        (length.shorter, length.shorter_limit), (length.longer, length.longer_limit)))
    if is_free(length):
        low, high = length.bounds
        beyond = BEYOND * (below + above)
        below, above = (min(below, length.value - low + beyond),
                        min(above, high - length.value + beyond))
    least = min(half, 1.2 * deviation)
    return length.value - max(below, least), length.value + max(above, least)


def axis_text(low, high):
    """An axis of about DESIGNS values between two lengths, as first:last:step."""
    step = float(f"{(high - low) / DESIGNS:.2g}")
    first, last = (step * round(value / step) for value in (low + step, high - step))
    return f"{first:.12g}:{last:.12g}:{step:.12g}"


def sweep(program, job, directory, name):
    """Sweeps a job with explicit axes, of which only `name` has several values; its archive."""
    output = os.path.join(directory, name + ".h5")
    checked(command("sweep", job_text(job), "--output.file", output, program=program))
    return only(load(output))


def sweep_panels(program, optimum):
    """{name: Archive} with the objective and the constrained fields of each panel's designs."""
    fields = {optimum.objective, *(constraint.field for constraint in field_constraints(optimum))}
    job = {**without_sections(accurate_job(optimum.job), "lattice", "output", "optimum"),
           ("solver", "check"): "no", ("output", "fields"): ", ".join(sorted(fields))}
    fixed = {("lattice", name): repr(length.value) for name, length in optimum.lengths.items()}
    with tempfile.TemporaryDirectory() as directory:
        return {name: sweep(program, {**job, **fixed, ("lattice", name): axis_text(
            *extent(optimum.lengths[name], optimum.deviation))}, directory, name)
            for name in PANELS}


def dataset(field):
    """The name of a field's dataset."""
    return field.replace("-", "_")


def amount(value, unit, digits=6):
    """A value with its unit, as text."""
    factor, unit = readable_unit(unit, abs(value))
    return f"{factor * value:.{digits}g} {unit}".rstrip()


def with_zeros(x, y):
    """The points of a piecewise linear curve, and those where it crosses zero."""
    first = np.flatnonzero(y[:-1] * y[1:] < 0)
    zeros = x[first] - y[first] * (x[first + 1] - x[first]) / (y[first + 1] - y[first])
    order = np.argsort(np.concatenate([x, zeros]), kind="stable")
    return (np.concatenate([x, zeros])[order],
            np.concatenate([y, np.zeros(len(zeros))])[order])


def draw_regions(axes, archive, name, constraints):
    """Shades the designs that violate each constraint, over the height of the panel."""
    for constraint, colour in zip(constraints, COLOURS * len(constraints)):
        field = dataset(constraint.field)
        x = archive.axes[name]
        rounding = 1e-9 * max(1, abs(constraint.limit))
        excess = constraint.sign * (archive.data[field].values.ravel() - constraint.limit) - rounding
        if (excess > 0).any():
            x, excess = with_zeros(x, excess)
            axes.fill_between(x, 0, 1, where=excess >= 0, transform=axes.get_xaxis_transform(),
                              color=colour, alpha=0.18, linewidth=0, zorder=0.5,
                              label=f"{constraint.field} {'>' if constraint.sign > 0 else '<'} "
                                    f"{amount(constraint.limit, archive.unit(field))}")


def draw_bounds(axes, length):
    """Draws the bounds of the lattice, unless the length is fixed."""
    for bound in length.bounds if is_free(length) else ():
        axes.axvline(bound, color="black", linestyle=":", label="bound of the lattice")


def draw_deviation(axes, length, optimum, factor, unit):
    """Draws the deviation of a length, and the worst and the expected objective."""
    unreleased = "" if optimum.worst is not None else ", with designs that have no release"
    axes.axvspan(length.value - optimum.deviation, length.value + optimum.deviation, linewidth=0,
                 color="tab:green", alpha=0.15,
                 label=f"deviation of up to {1000 * optimum.deviation:g} mm{unreleased}")
    for word, value, style in (("expected", optimum.expected, "--"),
                               ("worst", optimum.worst, "-.")):
        if value is not None:
            axes.axhline(factor * value, color="tab:green", linestyle=style, linewidth=1,
                         label=f"{word} value, all lengths off by up to that: "
                               f"{amount(value, unit)}")


def draw_loss(axes, length, least):
    """Draws the value 1 % below the optimum, and where the objective falls below it, unless a limit
    comes first."""
    axes.axhline(least, color="grey", linewidth=0.8, label="1 % less than the optimum")
    ends = [length.value + loss
            for loss, limit in ((-length.shorter, length.shorter_limit),
                                (length.longer, length.longer_limit))
            if np.isfinite(loss) and not limit]
    if ends:
        axes.plot(ends, [least] * len(ends), "|", color="black", markersize=10,
                  label="where 1 % is lost")


def limit_text(limit, archive):
    """A limit with its unit, such as "peak-beam-stress <= 60 MPa"."""
    if "=" not in limit:
        return limit  # no release
    name, relation, value = limit.rsplit(" ", 2)
    if dataset(name) not in archive.fields and not re.fullmatch(r"r\d( \+ r\d)*", name):
        return limit  # a formula
    unit = archive.unit(dataset(name)) if dataset(name) in archive.fields else "m"
    return f"{name} {relation} {amount(float(value), unit)}"


def loss_text(length, archive):
    """How much shorter and longer a length may be before 1 % is lost, or a limit passed."""
    sides = []
    for word, loss, limit in (("shorter", length.shorter, length.shorter_limit),
                              ("longer", length.longer, length.longer_limit)):
        size = "any length" if np.isinf(loss) else f"{round(1000 * loss, 4):.3g} mm"
        sides.append(f"{size} {word}" + (f" ({limit_text(limit, archive)})" if limit else ""))
    separator = "\n" if length.shorter_limit or length.longer_limit else " "
    return "within 1 %: " + f"{separator}or ".join(sides)


def draw_panel(axes, archive, name, optimum):
    """Draws the objective against a length."""
    length, field = optimum.lengths[name], dataset(optimum.objective)
    factor = readable_unit(archive.unit(field), abs(optimum.value))[0]
    least = optimum.value - 0.01 * abs(optimum.value)
    if optimum.deviation > 0:
        draw_deviation(axes, length, optimum, factor, archive.unit(field))
    axes.plot(archive.axes[name], factor * archive.data[field].values.ravel(), color="tab:blue",
              label=f"{optimum.objective} of the designs")
    draw_bounds(axes, length)
    draw_loss(axes, length, factor * least)
    axes.plot(length.value, factor * optimum.value, "*", color="red", markeredgecolor="black",
              markersize=14, zorder=3,
              label=f"optimum: {amount(optimum.value, archive.unit(field), 8)}")
    axes.set_xlim(*archive.axes[name][[0, -1]])
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.set_xlabel(wrapped(f"{archive.long_name(name)} {name} (m)", 1.9))
    axes.set_title(f"{name} = {length.value:.7f} m{'' if is_free(length) else ' (fixed)'}\n"
                   f"{wrapped(loss_text(length, archive), 1.75)}")


def set_heights(panels, optimum, factor):
    """Gives all panels the same vertical axis: what is drawn, as far as it is near the optimum."""
    bottoms, tops = zip(*(axes.get_ylim() for axes in panels))
    margin = HEIGHT * (abs(optimum.value) or np.inf)
    lowest = optimum.value if optimum.worst is None else min(optimum.value, optimum.worst)
    for axes in panels:
        axes.set_ylim(max(min(bottoms), factor * (lowest - margin)),
                      min(max(tops), factor * (optimum.value + margin)))


def title(name, optimum, archive):
    """The title: the job, the optimum and its constraints."""
    texts = [limit_text(c.text, archive) for c in optimum.given_constraints]
    text = f"{name}: neighbourhood of the {WORDS[optimum.job['optimum', 'robust']]}, " \
           f"{optimum.objective} {amount(optimum.value, archive.unit(dataset(optimum.objective)))}"
    return f"{text}, subject to {', '.join(texts)}" if texts else text


def draw(name, optimum, archives):
    """The figure: a panel for each length, and the legend below them."""
    figure, (panels,), below = with_legend(0.62, 6, 1, len(PANELS), sharey=True)
    archive, field = archives[PANELS[0]], dataset(optimum.objective)
    factor, unit = readable_unit(archive.unit(field), abs(optimum.value))
    for panel, length in zip(panels, PANELS):
        draw_panel(panel, archives[length], length, optimum)
    set_heights(panels, optimum, factor)
    for panel, length in zip(panels, PANELS):
        draw_regions(panel, archives[length], length, field_constraints(optimum))
    panels[0].set_ylabel(wrapped(labelled(archive.long_name(field), unit), 2.5))
    entries = {text: handle for panel in panels
               for handle, text in zip(*panel.get_legend_handles_labels())}
    below.legend(entries.values(), entries.keys(), loc="center", ncol=2, columnspacing=1)
    set_title(figure, title(name, optimum, archive))
    return figure


def main():
    split = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    parser = Parser(__doc__)
    parser.usage = "%(prog)s [-h] [--program PROGRAM] [-o PICTURE] JOB [-- OPTIONS]"
    parser.add_argument("job", metavar="JOB", help="job file")
    parser.add_argument("--program", help=PROGRAM_HELP)
    add_output(parser, "the job's name with -neighbourhood.png, in the working directory")
    arguments = parser.parse_args(sys.argv[1:split])

    name = os.path.splitext(os.path.basename(arguments.job))[0]
    output = arguments.output or f"{name}-neighbourhood.png"
    check_output(output, arguments.job)
    program = find_program(arguments.program)
    optimum = read_optimum(parse_optimum(run_program(program, "optimum", arguments.job, "--json",
                                                     *sys.argv[split + 1:])))
    save(draw(name, optimum, sweep_panels(program, optimum)), output)
