"""Draws a sheet to build a machine from: one page with the best design of a job, to scale.

It shows the machine at the start and at the release with all dimensions and the paths of projectile
and counterweight, and lists lengths with what each may be off before 1 % is lost, the angle of the
pin, what to expect, loads, clearances and masses. JOB is a job file, whose optimum is searched for,
or what `trebsweep optimum JOB --json` printed. A name that ends in .dxf is a drawing with layers for
CAD programs, in m or in inches.

  treb-plot sheet jobs/backyard.cfg                     -> backyard.pdf
  treb-plot sheet backyard.json --units us -o sheet.dxf
"""

import functools
import importlib.util
import json
import os
import re

import numpy as np

from . import api, drawing
from .design_drawing import Machine, arranged, panels
from .job import accurate_job, job_text, parse_job
from .launch import PROGRAM_HELP, find_program, parse_optimum, run_program
from .picture import FORMATS, check_output, picture_format, plt, save
from .program import Parser, check_new, fail
from .units import UNITS

ROWS = 150  # of a traced swing
PAPERS = {"a4": (11.69, 8.27), "letter": (11, 8.5)}  # inches
NEEDED = {"job", "one_percent_loss", "pin_angle_loss", "values", "units", "warnings"}  # of an optimum
# What built machines reached of the range computed without friction and drag.
BUILT = ("Two built machines reached 80 % (laboratory, arXiv:2502.19442) and 67 % (hobby, ra226.net) of their "
         "computed range without friction and drag. This is no promise.")


def read_optimum(path, program, ranks):
    """The object of `trebsweep optimum --json`: that of a file, or of a search for a job's optimum."""
    if not os.path.isfile(path):
        fail(f"{path}: no such file")
    with open(path, encoding="utf-8", errors="replace") as file:
        text = file.read()
    if not text.strip():
        fail(f"{path}: is empty; did trebsweep optimum find nothing?")
    if text.lstrip().startswith("{"):
        try:
            optimum = json.loads(text)
            return optimum if NEEDED <= set(optimum) else fail(f"{path}: is not an optimum")
        except ValueError as error:
            fail(f"{path}: is damaged: {error}")
    return parse_optimum(run_program(program, "optimum", path, "--json", ranks=ranks))


def trace(optimum, program):
    """The swing of an optimum, a table of rows and comments."""
    job = job_text(accurate_job(parse_job(optimum["job"])))
    return api.trace(job, *(optimum[name] for name in ("r1", "r2", "r3")), interval=optimum["release_time"] / ROWS,
                     program=program)


def limit_text(optimum, text, units):
    """A limit such as "r1 + r2 <= 2.4384" with the unit of its fields, lengths or variable."""
    parts = re.fullmatch(r"(.*) ([<>]=) ([-+.\de]+)", text)
    if not parts:
        return text  # no release, or a bound such as r1 <= h0 - r4
    name, relation, limit = parts.groups()
    unit = {**optimum["units"], **optimum["constraint_units"]}.get(name, "m")  # of a length
    return f"{name} {relation} {units.quantity(float(limit), unit)}"


def allowance(off, limits, words, tell):
    """How far a dimension may be off to both sides, and which of them, in words, matters."""
    shown = ["any" if length is None else sign + tell(length) for sign, length in zip("-+", off)]
    notes = [f"not {word}: {limit}" for word, limit in zip(words, limits) if limit]
    known = [np.inf if length is None else length for length in off]
    if not notes and max(known) > 1.5 * min(known):
        notes = [f"rather {words[int(known[1] > known[0])]}"]
    return " / ".join(shown), "; ".join(notes)


def side_text(x, units):
    """A horizontal distance from the axle."""
    return f"{units.length(abs(x))} from the axle, {'counterweight' if x > 0 else 'sling'}'s side"


HANGER, HANGER_TEXT = "counterweight-hanger", "hanger r4, to the box's centre of mass"


def length_rows(machine, units):
    """(name, value, allowance, note) of all lengths and angles."""
    optimum = machine.optimum
    loss = optimum["one_percent_loss"]
    limits, pin_limits = ([[limit and limit_text(optimum, limit, units) for limit in pair] for pair in pairs]
                          for pairs in (optimum["one_percent_limit"], [optimum["pin_angle_limit"] or (None, None)]))
    rows = [(f"{words} {name}", units.length(optimum[name]),
             *allowance(loss[i], limits[i], ("shorter", "longer"), units.small))
            for words, name, i in (("counterweight arm", "r1", 0), ("throwing arm", "r2", 2), ("sling", "r3", 1))]
    for i, (name, value) in enumerate(optimum["variables"].items(), len(rows)):
        unit = optimum["units"][name]
        tell = functools.partial(units.quantity, unit=unit)
        rows.append((HANGER_TEXT if name == HANGER else name.replace("-", " "), tell(value),
                     *allowance(loss[i], limits[i], ("less", "more"), units.small if unit == "m" else tell)))
    rows.append(("whole beam r1 + r2", units.length(machine.r1 + machine.r2), "", ""))
    if machine.r4 and HANGER not in optimum["variables"]:
        rows.append((HANGER_TEXT, units.length(machine.r4), "", ""))
    rows.append(("axle above the ground", units.length(machine.h0), "", ""))
    if machine.has_trough:
        rows.append(("trough above the ground", units.length(machine.number("trough-height")), "", ""))
        rows += [(f"projectile {when}", side_text(x, units), "", "")
                 for when, x in zip(("at the start", "leaves the trough"), machine.trough())]
    tip = machine.points(0)[2]
    rows.append(("arm's tip at the start, above the ground", units.length(max(tip[1] + machine.h0, 0)), "", ""))
    rows.append(("counterweight arm at the start, from upright", units.angle(machine.swing["phi1"][0]), "", ""))
    pin = optimum["pin_angle_loss"]
    rows.append(("pin, from the arm's line", units.angle(machine.value("pin-angle")),
                 *(allowance(pin, pin_limits[0], ("less", "more"), units.degrees) if pin
                   else ("", "no pin makes this release"))))
    return rows


def performance_rows(machine, units):
    """(name, value) of what to expect."""
    def shown(field, tell):
        value = machine.value(field)
        return "none: released below the ground" if value is None else tell(value)

    rows = [("range", shown("range", units.distance))]
    wind = machine.optimum.get("range_with_wind")
    if wind:
        rows += [(f"range, {units.speed(5)} less / more wind",
                  f"{units.distance(wind['less'])} / {units.distance(wind['more'])}")]
    worst, expected = machine.optimum["worst"], machine.optimum["expected"]
    if worst is not None:
        unit = objective_unit(machine.optimum)
        tell = units.distance if unit == "m" else functools.partial(units.quantity, unit=unit)
        rows.append((f"{machine.optimum['objective']}, lengths off by up to {units.small(machine.deviation)}",
                     f"at least {tell(worst)}, mean {tell(expected)}"))
    drag = machine.number("projectile-diameter")
    return rows + [
        ("drag", f"of a ball of {units.small(drag)}" if drag else "none"),
        ("speed at the release", units.speed(machine.value("speed"))),
        ("speed at the impact", shown("impact-speed", units.speed)),
        ("energy efficiency", f"{100 * machine.value('efficiency'):.0f} %"),
        ("time to the release", f"{machine.optimum['release_time']:.3f} s")]


def load_rows(machine, units):
    """(name, value) of loads, clearances and masses."""
    rows = [(name, tell(machine.value(field))) for name, field, tell in (
        ("axle, largest force", "peak-axle-load", units.force),
        ("sling, largest tension", "peak-sling-tension", units.force),
        ("sling, smallest tension", "least-sling-tension", units.force),
        ("hanger, largest tension", "peak-hanger-tension", units.force),
        ("hanger, smallest tension", "least-hanger-tension", units.force),
        ("beam, bending stress at the axle", "peak-beam-stress", units.stress),
        ("counterweight's centre, least height", "counterweight-clearance", units.length),
        ("projectile's centre, least height", "projectile-clearance", units.length))
            if machine.value(field) is not None]
    mass, section = machine.beam()
    rows += [("counterweight", units.mass(machine.number("counterweight-mass"))),
             ("projectile", units.mass(machine.number("projectile-mass"))),
             ("beam", units.mass(mass) + (f", {units.small(section[0])} wide, {units.small(section[1])} deep"
                                          if section else ", measured"))]
    if machine.number("sling-mass"):
        rows.append(("sling", units.mass(machine.number("sling-mass"))))
    return rows


def objective_unit(optimum):
    """The unit of the objective."""
    return optimum["units"][optimum["objective"]]


def provenance(machine, name):
    """Where the numbers come from."""
    optimum = machine.optimum
    unit = objective_unit(optimum)
    bound = 10.0 ** np.ceil(np.log10(max(optimum["error"], 1e-9)))
    error = f"{bound:.0e} {'' if unit == '1' else unit}".rstrip()
    lines = [f"{name}: {optimum['sought']}, with an error below {error}. {optimum['version']}.", BUILT]
    if any(limit for pair in optimum["one_percent_limit"] for limit in pair) and not machine.deviation:
        lines.append("Where a limit is reached, there is no room to one side: optimum.deviation with "
                     "optimum.robust = worst leaves it.")
    return lines


def texts(machine, units):
    """The lines of the table, {title: rows}; a row is (name, value, allowance, note) or shorter."""
    return {"Dimensions, and what loses 1 %": length_rows(machine, units),
            "What to expect": performance_rows(machine, units),
            "Loads, clearances, masses": load_rows(machine, units)}


def write_table(figure, left, top, tables):
    """Writes tables down a column of a page from its upper left corner, as parts of the page."""
    notes = sum(len(row) > 3 and bool(row[3]) for rows in tables.values() for row in rows)
    steps = sum(len(rows) + 1.85 for rows in tables.values()) + 0.75 * notes
    step, width = min(0.0205, (top - 0.09) / steps), 0.985 - left  # down to the lines at the bottom
    for title, rows in tables.items():
        figure.text(left, top, title, fontsize=9, weight="bold", va="top")
        top -= 1.25 * step
        for name, value, *others in rows:
            figure.text(left, top, name, fontsize=7, va="top")
            figure.text(left + (0.62 if any(others) else 1) * width, top, value, fontsize=7, va="top", ha="right")
            if any(others):
                figure.text(left + width, top, others[0], fontsize=7, va="top", ha="right")
            if len(others) > 1 and others[1]:
                top -= 0.75 * step
                figure.text(left + width, top, others[1], fontsize=5.5, va="top", ha="right", color="0.3")
            top -= step
        top -= 0.6 * step


def draw_page(machine, name, units, paper):
    """The figure of a page."""
    figure = plt.figure(figsize=PAPERS[paper], layout="none")
    axes = figure.add_axes((0.015, 0.08, 0.565, 0.81))
    axes.set_aspect("equal")
    axes.set_axis_off()
    size = axes.get_window_extent()
    shapes = arranged(*panels(machine, units), size.width / size.height)
    low, high = drawing.bounds(shapes)
    margin = 0.08 * (high - low).max()  # for texts
    axes.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
    drawing.draw(axes, shapes)
    figure.text(0.02, 0.965, f"Build sheet: {name}", fontsize=14, weight="bold", va="top")
    figure.text(0.02, 0.93, "To scale; frame and counterweight are symbols. Dashed: paths of projectile and "
                "counterweight", fontsize=8, va="top", color="0.3")
    for i, warning in enumerate(machine.optimum["warnings"]):
        figure.text(0.02, 0.905 - 0.022 * i, f"Warning: {warning}", fontsize=8, va="top", color="tab:red")
    write_table(figure, 0.6, 0.965, texts(machine, units))
    for i, line in enumerate(provenance(machine, name)):
        figure.text(0.02, 0.065 - 0.022 * i, line, fontsize=6.5, va="top", color="0.25", wrap=True)
    return figure


def write_dxf(path, machine, name, units):
    """Writes the drawing with its table as a DXF file."""
    if importlib.util.find_spec("ezdxf") is None:
        fail("sheet: DXF needs the module ezdxf (Debian: python3-ezdxf)")
    lines = [f"Build sheet: {name}", *(f"Warning: {text}" for text in machine.optimum["warnings"])]
    for title, rows in texts(machine, units).items():
        lines += ["", title, *("   ".join(filter(None, row)) for row in rows)]
    try:
        drawing.write_dxf(path, arranged(*panels(machine, units), 1.5), units.dxf_factor, units.dxf_code,
                          lines + [""] + provenance(machine, name))
    except OSError as error:
        fail(f"{path}: cannot be written: {error.strerror}")
    print(path)


def main():
    parser = Parser(__doc__)
    parser.add_argument("job", metavar="JOB", help="a job file, or the JSON of trebsweep optimum")
    parser.add_argument("--units", choices=UNITS, default="si", help="units of the sheet (default: si)")
    parser.add_argument("--paper", choices=PAPERS, help="size of the page (default: a4, of us units letter)")
    parser.add_argument("-n", "--ranks", type=int, metavar="RANKS", help="search on that many ranks of mpirun")
    parser.add_argument("-o", "--output", metavar="FILE",
                        help=f"the suffix selects the format ({', '.join(FORMATS)}, dxf); default: JOB.pdf")
    parser.add_argument("--overwrite", action="store_true", help="replace an existing DXF file")
    parser.add_argument("--program", help=PROGRAM_HELP)
    arguments = parser.parse_args()

    name = os.path.splitext(os.path.basename(arguments.job))[0]
    output = arguments.output or f"{name}.pdf"
    is_dxf = picture_format(output) == "dxf"
    if is_dxf:
        check_new("output", output, arguments.overwrite, arguments.job)
    else:
        check_output(output, arguments.job)
    program, units = find_program(arguments.program), UNITS[arguments.units]
    optimum = read_optimum(arguments.job, program, arguments.ranks)
    machine = Machine(optimum, trace(optimum, program))
    if is_dxf:
        write_dxf(output, machine, name, units)
    else:
        paper = arguments.paper or ("letter" if arguments.units == "us" else "a4")
        save(draw_page(machine, name, units, paper), output)
