"""Draws the optimum of each scene of a study against the study's outer axes.

The quantities are the optimum's value, its lengths r1, r2 and r3, and the ratios r3/r2, r2/r1 and
(r2+r3)/h0, where h0 is the scene's fulcrum height. One outer axis gives curves, two give maps. Of
more, the first two are drawn, or those of --x and --y; --at chooses a value of another one,
otherwise it is that of the best scene. A star marks the best of the scenes drawn.
Scenes that are not done, or without an optimum, are left blank. Axes whose values are spaced more
evenly on a logarithmic scale are drawn on one. Curves break where the optimum jumps from one local
maximum to another: where it moves by more than 3 steps of the lattice, and more than 2.5 times
faster than in the intervals before and after.

The table of what is drawn goes to stdout. With --csv, it has SI units and all digits, and no
picture is drawn. The study needs no maps (output.maps = none).

  treb-plot study masses.h5                                   -> masses-study.png
  treb-plot study masses.h5 --at fulcrum-height=2 --quantity r3/r2 --quantity "(r2+r3)/h0"
  treb-plot study masses.h5 --x fulcrum-height --y projectile-mass -o masses.pdf
  treb-plot study weights.h5 --x "counterweight-mass / projectile-mass"
  treb-plot study masses.h5 --csv > masses.csv
"""

from collections import namedtuple

import numpy as np
import pandas

from .accessor import edges, key_of, stem
from .expressions import Expression
from .picture import (COLOURS, MARKERS, add_output, check_output, labelled, plt, readable_unit, save, set_title, size,
                      wrapped)
from .program import Parser, fail, note, refuse
from .scenes import load, select

# Quantities drawn together in one panel of curves, and those drawn by default.
LENGTHS = ("r1", "r2", "r3")
RATIOS = ("r3/r2", "r2/r1", "(r2+r3)/h0")
DEFAULT = ("value", *LENGTHS, *RATIOS)
QUANTITIES = ("value", "speed", "release-time", "error", *LENGTHS, *RATIOS)

JUMP_STEPS, JUMP_RATIO = 3, 2.5  # of a jump of the optimum, see jumps()

# A quantity of the optima: its description, its unit, and its values over the outer axes.
Quantity = namedtuple("Quantity", "label unit values")


def read_quantities(archive):
    """{name: Quantity} of the optima."""
    best = archive.optima()
    r1, r2, r3 = (best[name] for name in LENGTHS)
    objective, unit = archive.objective
    lengths = {name: Quantity(f"length {name} of the optimum", "m", best[name])
               for name in LENGTHS}
    ratios = zip(RATIOS, (r3 / r2, r2 / r1, (r2 + r3) / height_h0(archive)))
    return {"value": Quantity(f"{objective} of the optimum", unit, best["value"]),
            "speed": Quantity("speed of the optimum", "m/s", best["speed"]),
            "release-time": Quantity("release time of the optimum", "s", best["release_time"]),
            "error": Quantity(f"error of the optimum's {objective}", unit, best["error"]),
            **lengths, **{name: Quantity(name, "", values) for name, values in ratios}}


def height_h0(archive):
    """The fulcrum height of the scenes, m: a number, or an array that broadcasts to the outer axes."""
    if "fulcrum_height" not in archive.data.coords or not archive.data["fulcrum_height"].ndim:
        return archive.numbers.get("fulcrum_height", np.nan)
    axis = archive.outer.index(archive.data["fulcrum_height"].dims[0])
    return archive.data["fulcrum_height"].values.reshape([-1 if i == axis else 1 for i in range(len(archive.outer))])


def is_geometric(values):
    """Whether values are spaced more evenly on a logarithmic scale."""
    if len(values) < 3 or values[0] <= 0 or values[0] == values[-1]:
        return False
    unevenness = [np.std(steps) / np.mean(steps) for steps in (np.diff(values),
                                                               np.diff(np.log(values)))]
    return unevenness[1] < unevenness[0]


def cell_edges(values):
    """The boundaries of cells around the values of an axis."""
    return np.exp(edges(np.log(values))) if is_geometric(values) else edges(values)


def set_scale(axis, values):
    """Scales an axis of a panel. Few values get a tick each; many, on a logarithmic scale, have
    ticks at some of them."""
    most = 8
    if is_geometric(values):
        most = 4
        axis.axes.set(**{f"{axis.axis_name}scale": "log"})
        axis.set_ticks([], minor=True)
    elif len(values) > 8:
        return
    ticks = values[::-(-len(values) // most)]
    axis.set_ticks(ticks, labels=[f"{value:.4g}" for value in ticks])


def axis_label(archive, name):
    """The label of an outer axis."""
    return wrapped(labelled(archive.short_name(name), archive.unit(name)), 2)


def best_scene(archive, quantities):
    """The index of the best scene along the outer axes."""
    return np.unravel_index(np.nanargmax(quantities["value"].values), archive.outer_shape)


def scaled(quantity):
    """The values of a quantity in a readable unit, and its label with this unit."""
    factor, unit = readable_unit(quantity.unit, np.nanmax(np.abs(quantity.values), initial=0))
    return factor * quantity.values, labelled(quantity.label, unit)


def limits(values, margin):
    """The limits of an axis or a colour bar, with a margin as a share of the values' range.
    Differences due to rounding are not magnified."""
    low, high = np.nanmin(values), np.nanmax(values)
    beyond = margin * (high - low) if high - low > 1e-6 * abs(high) else 0.05 * abs(high) or 1
    return low - beyond, high + beyond


def grid(count, x_label, y_label=None):
    """A figure with panels for `count` quantities that share x, and with a label of y also y."""
    columns = count if count <= 3 else -(-count // 2)
    rows = -(-count // columns)
    figure, panels = plt.subplots(rows, columns, squeeze=False, sharex=True, sharey=bool(y_label),
                                  figsize=size(0.12 + rows * (0.34 if columns < 4 else 0.28)))
    for unused in panels.flat[count:]:
        unused.remove()
    for axes in panels.flat[max(count - columns, 0):count]:  # the lowest of each column
        axes.set_xlabel(x_label)
        axes.tick_params(labelbottom=True)
    for axes in panels[:, 0]:
        axes.set_ylabel(y_label)
    return figure, panels.flat[:count]


def jumps(archive, quantities):
    """Whether the optimum jumps to another local maximum, in each interval of the only outer axis:
    by more than JUMP_STEPS of the lattice, and more than JUMP_RATIO times faster than in the
    intervals before and after. The first and the last interval lack one of these: False."""
    (x,) = archive.outer_axes.values()
    move = np.linalg.norm(np.diff([quantities[name].values for name in LENGTHS]), axis=0)
    speed = move / np.diff(np.log(x) if is_geometric(x) else x)
    step = max(np.diff(values).max(initial=0) for values in archive.axes.values())
    found = np.zeros(len(move), bool)
    found[1:-1] = (move[1:-1] > JUMP_STEPS * step) & (
        speed[1:-1] > JUMP_RATIO * np.maximum(speed[:-2], speed[2:]))
    return found


def has_curves(archive):
    """Whether no scenes share a value of the only outer axis, as they may if it is an expression."""
    return (np.diff(*archive.outer_axes.values()) > 0).all()


def draw_curves(archive, quantities, names, star):
    """The figure of quantities against the only outer axis, broken where the optimum jumps. Lengths
    share a panel."""
    (x,) = archive.outer_axes.values()
    is_curve = has_curves(archive)
    breaks = np.flatnonzero(jumps(archive, quantities)) + 1 if is_curve else []
    lengths = [name for name in names if name in LENGTHS]
    groups = list(dict.fromkeys(tuple(lengths) if name in lengths else (name,) for name in names))
    figure, panels = grid(len(groups), axis_label(archive, archive.outer[0]))
    for axes, group in zip(panels, groups):
        for name, colour, marker in zip(group, COLOURS, MARKERS):
            values, label = scaled(quantities[name])
            axes.plot(*(np.insert(v, breaks, np.nan) for v in (x, values)), color=colour,
                      label=name, marker=marker if len(x) < 50 or not is_curve else "", markersize=4,
                      linestyle="-" if is_curve else "none")
            axes.plot(x[star], values[star], "*", color=colour, markersize=13,
                      markeredgecolor="black", clip_on=False, zorder=3)
        axes.set_ylim(limits([scaled(quantities[name])[0] for name in group], 0.05))
        axes.set_ylabel(wrapped(label if len(group) == 1 else "lengths of the optimum (m)", 1.9))
        axes.grid(True, color="0.9")
        if len(group) > 1:
            axes.legend()
    set_scale(panels[0].xaxis, x)
    return figure


def draw_maps(archive, quantities, names, star):
    """The figure of quantities as maps over two outer axes: x, y."""
    (x_name, x), (y_name, y) = archive.outer_axes.items()
    figure, panels = grid(len(names), axis_label(archive, x_name), axis_label(archive, y_name))
    for axes, name in zip(panels, names):
        values, label = scaled(quantities[name])
        low, high = limits(values, 0)
        mesh = axes.pcolormesh(cell_edges(x), cell_edges(y), values.T, cmap="viridis", vmin=low,
                               vmax=high, rasterized=True)
        figure.colorbar(mesh, ax=axes).set_label(wrapped(label, 1.9))
        axes.plot(x[star[0]], y[star[1]], "*", color="red", markersize=12, markeredgecolor="white",
                  clip_on=False)
    set_scale(panels[0].xaxis, x)
    set_scale(panels[0].yaxis, y)
    return figure


def scene_text(archive, index):
    """The values of the outer axes in a scene, as text."""
    return ", ".join(f"{key_of(name)} = {values[i]:.6g} {archive.unit(name)}".rstrip()
                     for (name, values), i in zip(archive.outer_axes.items(), index))


def is_constant(values):
    """Whether values differ by rounding alone."""
    return np.nanmax(values) - np.nanmin(values) <= 1e-6 * np.nanmax(np.abs(values))


def edge_text(archive, index):
    """That a scene lies at the edge of the study's ranges, as text."""
    at_edge = [key_of(name) for (name, values), i in zip(archive.outer_axes.items(), index)
               if len(values) > 2 and i in (0, len(values) - 1)]
    return f"; at the edge of the range of {' and '.join(at_edge)}" if at_edge else ""


def picture(archive, names):
    """The figure of some quantities of the optima over one or two outer axes."""
    quantities = read_quantities(archive)
    star = best_scene(archive, quantities)
    constant = {name: quantities[name].values[star] for name in names
                if name in RATIOS and is_constant(quantities[name].values)}
    varying = [name for name in names if name not in constant] or names
    draw = draw_curves if len(archive.outer) == 1 else draw_maps
    figure = draw(archive, quantities, varying, star)
    title = f"{archive.name()}: optimum of each scene"
    if archive.keys.get(("optimum", "refine")) == "yes":
        title += " (continuous)"
    title = ", ".join([title, *archive.conditions()])
    if not archive.complete:
        title += f"; {archive.progress()}"
    if len(archive.outer) == 1 and has_curves(archive) and jumps(archive, quantities).any():
        title += "\ncurves break where the optimum jumps to another local maximum"
    same = ""
    if varying != names:
        same = "\nin all scenes: " + ", ".join(f"{name} = {value:.6g}" for name, value in constant.items())
    value = quantities["value"]
    factor, unit = readable_unit(value.unit, abs(value.values[star]))
    amount = f"{archive.objective[0]} {factor * value.values[star]:.6g} {unit}".rstrip()
    place = scene_text(archive, star) + edge_text(archive, star)
    set_title(figure, f"{title}\n\u2605 best of all: {amount} at {place}{same}")
    return figure


def table(archive, names):
    """The quantities of the scenes, a row per scene; columns (name, unit)."""
    outer = np.meshgrid(*archive.outer_axes.values(), indexing="ij")
    quantities = read_quantities(archive)
    return pandas.DataFrame({
        **{(key_of(name), archive.unit(name)): values.ravel() for name, values in zip(archive.outer, outer)},
        **{(name, quantities[name].unit): quantities[name].values.ravel() for name in names}})


def order(archive, x, y):
    """The archive with x and y as its first and second outer axis, as far as they are given."""
    for option, key in (("y", y), ("x", x)):
        if key is not None:
            if key.replace("-", "_") not in archive.outer:
                refuse(option, key, "must be one of the outer axes that --at leaves: " + (
                    ", ".join(map(key_of, archive.outer)) or "none"))
            archive = archive.first(key.replace("-", "_"))
    return archive


def against(archive, text):
    """The archive with an expression of outer axes and numbers of the scene as its only outer axis, increasing."""
    expression = Expression("x", text)
    axes = dict(zip(archive.outer, np.ix_(*archive.outer_axes.values())))
    known = {**archive.numbers, **axes}
    values = expression.evaluate(expression.parse(expression.joined(known)), known, {})
    values = np.broadcast_to(values, archive.outer_shape).ravel()
    scenes = archive.data.drop_vars(archive.fields).stack(scene=archive.outer).reset_index("scene")
    label = {"long_name": text.replace("_", " ").replace("-", " "), "units": ""}
    return scenes.rename(scene=text).assign_coords({text: (text, values, label)}).sortby(text).treb


def at_most_two_axes(archive):
    """The archive with its first two outer axes, at the best scene's values of the others."""
    values = read_quantities(archive)["value"].values
    if values.ndim <= 2 or np.isnan(values).all():
        return archive
    best = best_scene(archive, read_quantities(archive))
    chosen = [(key_of(name), axis[i]) for (name, axis), i in zip(archive.outer_axes.items(), best)]
    for key, value in chosen[2:]:
        note(f"{archive.path}: drawn at {key} = {value:g}, where the best scene is; --at chooses "
             f"another value")
    return archive.select(chosen[2:])


def main():
    parser = Parser(__doc__)
    parser.add_argument("archive", metavar="ARCHIVE",
                        help="archive of a study, or FILE.partial, an unfinished one")
    parser.add_argument("--quantity", choices=QUANTITIES, action="append", metavar="QUANTITY",
                        help="draw only this quantity; may be repeated; one of "
                        + ", ".join(QUANTITIES))
    parser.add_scene(what="draw only the scenes with this value")
    parser.add_argument("--x", metavar="KEY", help="the outer axis to draw horizontally, or an expression such as "
                        "\"counterweight_mass / projectile_mass\", against which all scenes are drawn")
    parser.add_argument("--y", metavar="KEY", help="the outer axis to draw vertically")
    parser.add_argument("--csv", action="store_true",
                        help="print the table as comma-separated values, and draw nothing")
    add_output(parser, "the archive's name with -study.png")
    arguments = parser.parse_args()

    if arguments.csv and arguments.output is not None:
        refuse("output", arguments.output, "must be left out with --csv, which writes to stdout")
    output = arguments.output or f"{stem(arguments.archive, arguments.at)}-study.png"
    check_output(output, arguments.archive)
    names = list(dict.fromkeys(arguments.quantity or DEFAULT))
    archive = load(arguments.archive)
    if not archive.in_study:
        fail(f"{arguments.archive}: is not a study: it has one scene")
    if arguments.x is not None and arguments.x == arguments.y:
        refuse("y", arguments.y, "must differ from x")
    archive = select(archive, arguments.at)
    if arguments.x is not None and any(sign in arguments.x for sign in "+*/"):
        archive = order(against(archive, arguments.x), None, arguments.y)
    else:
        archive = order(archive, arguments.x, arguments.y)
    if arguments.csv:
        print(table(archive, names).droplevel(1, axis=1).to_csv(index=False), end="")
        return
    archive = at_most_two_axes(archive)
    print(table(archive, names).to_string(index=False, na_rep="-", float_format="{:.7g}".format))
    if np.isnan(read_quantities(archive)["value"].values).all():
        note(f"{arguments.archive}: no scene has an optimum yet; no picture is drawn"
             if not archive.complete else
             f"{arguments.archive}: no scene has an optimum; no picture is drawn")
    elif len(archive.outer) == 0:
        note(f"{arguments.archive}: a single scene, printed as a table; no picture is drawn")
    else:
        save(picture(archive, names), output)
