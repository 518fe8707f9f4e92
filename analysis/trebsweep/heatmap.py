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
  treb-plot heatmap study.h5 --over projectile-mass           the plane r1 of each optimum, in one picture
"""

import numpy as np

from .accessor import design_text, stem
from .backend import AXES
from .maps import (PLANES, axis_label, contour_levels, draw, draw_plane, finite_values, flag_colours, middle, scaled,
                   shows, slices, views)
from .picture import add_output, check_output, labelled, plt, readable_unit, save, set_title, size, wrapped
from .program import Parser, key_of, note, refuse
from .scenes import load, only, select

# Fields whose best value is the largest or the smallest; in others, and in the objective, the star
# marks the sweep's optimum.
LARGEST = ("speed", "kinetic_energy", "efficiency", "range", "flight_time", "impact_speed", "apex",
           "least_sling_tension")
SMALLEST = ("release_time", "lift_off_time", "steps", "stiffness", "peak_sling_tension",
            "peak_axle_load", "peak_beam_stress", "peak_hanger_tension")
PERCENTILES = {"linear": (0, 100), "percentile": (2, 98)}


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


def colours(archive, values, scale):
    """Colour map and norm of numbers, arrays, on a linear or logarithmic scale or between percentiles."""
    finite = finite_values(values)
    if not finite.size:
        return {"cmap": "viridis", "vmin": 0, "vmax": 1}
    if scale == "log":
        positive = finite[finite > 0]
        if not positive.size:
            refuse("scale", scale, f"needs values above 0, of which the planes of {archive.path} have none")
        return {"cmap": "viridis", "norm": plt.matplotlib.colors.LogNorm(positive.min(), positive.max())}
    low, high = np.percentile(finite, PERCENTILES[scale])
    return {"cmap": "viridis", "vmin": low, "vmax": high}


def picture(archive, field, chosen, scale="linear"):
    """The figure of a map through its best design; `chosen` ({axis: m}) selects other planes."""
    star, star_text = best(archive, field)
    centre = {**(star or middle(archive)), **chosen}
    values = slices(archive, field, centre)
    if archive.is_number(field):
        values, unit = scaled(archive, field, values)
        look = {"label": labelled(archive.long_name(field), unit), "contours": True,
                "style": colours(archive, values, scale)}
    else:
        meanings = archive.meanings(field)
        look = {"label": "", "style": flag_colours(meanings), "meanings": meanings}
    seen = star and any(shows(archive, names, centre, star) for names in views(archive))
    mark = "\u2605 " if seen else ""
    return draw(archive, values, centre, f"{title(archive, field)}\n{mark}{star_text}", star=star,
                **look)


def multiples(archive, field, key, chosen, scale="linear"):
    """The figure of a plane of each scene along an outer axis, with the same colours and contours: at the value of a
    length in `chosen` ({axis: m}), else at the r1 of the scene's optimum."""
    fixed, value = next(iter(chosen.items()), ("r1", None))
    names = next(names for axis, *names in PLANES if axis == fixed)
    scenes = [archive.only([(key_of(key), x)]) for x in archive.data[key].values]
    centres = [value if value is not None else (scene.optimum() or (middle(scene),))[0][fixed] for scene in scenes]
    planes = [scene.section(field, names[::-1], {fixed: x}).values for scene, x in zip(scenes, centres)]
    planes, unit = scaled(archive, field, planes)
    columns = min(3, len(scenes))
    rows = -(-len(scenes) // columns)
    figure, panels = plt.subplots(rows, columns, squeeze=False, figsize=size(0.1 + 0.34 * rows))
    for unused in panels.flat[len(scenes):]:
        unused.remove()
    style, levels = colours(archive, planes, scale), contour_levels(planes)
    for axes, scene, x, plane in zip(panels.flat, scenes, centres, planes):
        mesh = draw_plane(axes, scene, names, plane, style, levels)
        axes.set_title(f"{key_of(key)} = {scene.selected[key]:g} {scene.unit(key)}\n{fixed} = "
                       f"{scene.axes[fixed][scene.nearest(fixed, x)]:g} m")
        axes.set_xlabel(axis_label(scene, names[0]))
    extend = "both" if scale == "percentile" else "neither"
    bar = figure.colorbar(mesh, ax=list(panels.flat[:len(scenes)]), extend=extend)
    bar.set_label(wrapped(labelled(archive.long_name(field), unit), figure.get_figheight() - 0.8))
    set_title(figure, title(archive, field))
    return figure


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


def over(archive, field, chosen, arguments):
    """Writes the picture of --over."""
    key = arguments.over.replace("-", "_")
    archive = select(archive, arguments.at)
    if archive.outer != [key]:
        refuse("over", arguments.over, "must be the only outer axis that --at leaves; these are left: "
               + (", ".join(map(key_of, archive.outer)) or "none"))
    if len(chosen) > 1:
        refuse("over", arguments.over, "takes only one of --r1, --r3 and --r2")
    output = arguments.output or f"{stem(arguments.archive, arguments.at)}-{key_of(field)}-over-{key_of(key)}.png"
    check_output(output, arguments.archive)
    save(multiples(archive, archive.number_field(field), key, chosen, arguments.scale), output)


def main():
    parser = Parser(__doc__)
    parser.add_argument("archive", metavar="ARCHIVE",
                        help="archive of a sweep, or FILE.partial, an unfinished one")
    parser.add_argument("--field", help="the map to draw (default: speed, or the first map "
                        "without a speed map); `trebsweep sweep --help-keys` lists the fields")
    parser.add_scene()
    for axis in AXES:
        parser.add_argument(f"--{axis}", type=float, metavar="M",
                            help=f"draw the plane at this value of the axis {axis}, in m "
                            "(default: the best design's)")
    parser.add_argument("--over", metavar="KEY", help="draw a plane for each value of this outer axis")
    parser.add_argument("--scale", choices=("linear", "log", "percentile"), default="linear",
                        help="of the colours: of all values, logarithmic, or from the 2nd to the 98th percentile")
    add_output(parser, "the archive's name with the field's and .png")
    arguments = parser.parse_args()

    archive = load(arguments.archive)
    field = archive.field(arguments.field or default_field(archive))
    chosen = {name: getattr(arguments, name) for name in AXES
              if getattr(arguments, name) is not None}
    if arguments.over:
        over(archive, field, chosen, arguments)
        return
    archive = only(archive, arguments.at)
    for axis, value in chosen.items():
        archive.index(axis, value)
    output = arguments.output or \
        f"{stem(arguments.archive, arguments.at)}-{field.replace('_', '-')}.png"
    check_output(output, arguments.archive)
    if views(archive):
        save(picture(archive, field, chosen, arguments.scale), output)
    else:
        print_design(archive, [field] if arguments.field else archive.fields)
        note(f"{arguments.archive}: holds a single design, printed as a table; no picture is drawn")
