"""Draws a map of an archive.

A sweep over three axes is drawn as the three planes through the best design in the quantity drawn,
such as the fastest, or the one with the smallest peak load. A star marks this design, and the title
names it. In the map of the objective, and in those of flags, angles, rates and errors, the star
marks the sweep's optimum, by default the fastest design. --r1, --r3 and --r2 choose other planes. A
sweep over two axes is drawn as one plane, over one axis as a line. A single design is printed as a
table, and no picture is written.

Cells outside the lattice are left blank, and so are designs that an unfinished sweep has not done.

  treb-plot heatmap accurate.h5                               speed -> accurate-speed.png
  treb-plot heatmap accurate.h5 --field status --r1 0.7
  treb-plot heatmap accurate.h5 --field peak-axle-load -o loads.pdf
  treb-plot heatmap study.h5 --at projectile-mass=100         -> study-projectile-mass=100-speed.png
"""

from .accessor import design_text, stem
from .backend import AXES
from .maps import draw, finite_values, flag_colours, middle, scaled, shows, slices, views
from .picture import add_output, check_output, labelled, readable_unit, save
from .program import Parser, note
from .scenes import load, only

# Fields whose best value is the largest or the smallest; in others, and in the objective, the star
# marks the sweep's optimum.
LARGEST = ("speed", "kinetic_energy", "efficiency", "range", "flight_time", "impact_speed", "apex",
           "least_sling_tension")
SMALLEST = ("release_time", "lift_off_time", "steps", "stiffness", "peak_sling_tension",
            "peak_axle_load", "peak_beam_stress", "peak_hanger_tension")


def default_field(archive):
    """The field that is drawn by default."""
    return "speed" if "speed" in archive.fields else next(iter(archive.fields), "speed")


def best(archive, field):
    """The best design of a map, {axis: m} or None, and its description."""
    so_far = "" if archive.complete else " so far"
    is_objective = field == archive.objective[0].replace("-", "_")
    if is_objective or field not in LARGEST + SMALLEST:
        optimum = archive.optimum()
        return optimum and optimum[0], f"{archive.best_word()}{so_far}: {archive.best_text()}"
    word = ("largest" if field in LARGEST else "smallest") + so_far
    found = archive.best(1, field if field in LARGEST else f"-{field}")
    if found.empty:
        return None, f"{word}: none"
    design, value = {name: found[name][0] for name in AXES}, found[field][0]
    factor, unit = readable_unit(archive.unit(field), abs(value))
    amount = f"{factor * value:.6g} {unit}".rstrip()
    return design, f"{word}: {amount} at {design_text(design)}"


def title(archive, field):
    """The title: the archive, the field and the solver."""
    text = f"{archive.name()}: {archive.long_name(field)}"
    stepper = archive.keys.get(("solver", "stepper"))
    if stepper:
        key = "time-step" if ("solver", "time-step") in archive.keys else "tolerance"
        value = archive.keys.get(("solver", key))
        unit = " s" if key == "time-step" else ""
        text += f" ({stepper}, {key.replace('-', ' ')} {value}{unit})" if value else f" ({stepper})"
    return text if archive.complete else f"{text}; {archive.progress()}"


def picture(archive, field, chosen):
    """The figure of a map through its best design; `chosen` ({axis: m}) selects other planes."""
    star, star_text = best(archive, field)
    centre = {**(star or middle(archive)), **chosen}
    values = slices(archive, field, centre)
    if archive.is_number(field):
        values, unit = scaled(archive, field, values)
        finite = finite_values(values)
        low, high = (finite.min(), finite.max()) if finite.size else (0, 1)
        look = {"label": labelled(archive.long_name(field), unit), "contours": True,
                "style": {"cmap": "viridis", "vmin": low, "vmax": high}}
    else:
        meanings = archive.meanings(field)
        look = {"label": "", "style": flag_colours(meanings), "meanings": meanings}
    seen = star and any(shows(archive, names, centre, star) for names in views(archive))
    mark = "\u2605 " if seen else ""
    return draw(archive, values, centre, f"{title(archive, field)}\n{mark}{star_text}", star=star,
                **look)


def print_design(archive, fields):
    """Prints the values of a lattice with one design."""
    rows = [(name, f"{archive.data[name].item():g}", "m") for name in AXES]
    for field in fields:
        value = archive.data[field].item()
        text = (f"{value:.10g}" if archive.is_number(field) else
                dict(enumerate(archive.meanings(field))).get(value, value))
        rows.append((field.replace("_", "-"), text, archive.unit(field)))
    for name, value, unit in rows:
        print(f"{name:20}{value} {unit}".rstrip())


def main():
    parser = Parser(__doc__)
    parser.add_argument("archive", metavar="ARCHIVE",
                        help="archive of a sweep, or FILE.partial, an unfinished one")
    parser.add_argument("--field", help="the map to draw (default: speed, or the first map "
                        "without a speed map); `trebsweep sweep --help` lists the fields")
    parser.add_scene()
    for axis in AXES:
        parser.add_argument(f"--{axis}", type=float, metavar="M",
                            help=f"draw the plane at this value of the axis {axis}, in m "
                            "(default: the best design's)")
    add_output(parser, "the archive's name with the field's and .png")
    arguments = parser.parse_args()

    archive = load(arguments.archive)
    field = archive.field(arguments.field or default_field(archive))
    archive = only(archive, arguments.at)
    chosen = {name: getattr(arguments, name) for name in AXES
              if getattr(arguments, name) is not None}
    for axis, value in chosen.items():
        archive.index(axis, value)
    output = arguments.output or \
        f"{stem(arguments.archive, arguments.at)}-{field.replace('_', '-')}.png"
    check_output(output, arguments.archive)
    if views(archive):
        save(picture(archive, field, chosen), output)
    else:
        print_design(archive, [field] if arguments.field else archive.fields)
        note(f"{arguments.archive}: holds a single design, printed as a table; no picture is drawn")
