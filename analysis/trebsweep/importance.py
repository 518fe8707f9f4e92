"""Prints and draws how much of a map's variance comes from each axis: Shapley effects.

The axes are r1, r3 and r2, and of a study its outer axes. All designs with a value count equally, in
all scenes. What some axes explain together is the variance of the means over designs that share
their values, as a share of the variance of all designs:

  effect  what the axis adds to what others explain, averaged over all orders in which the axes can be
          added (Shapley 1953, Owen 2014): the effects add up to 1
  alone   what the axis explains alone
  last    what it adds to all others

Effects are exact sums over the designs, without sampling. They also hold where the axes depend on
each other, as lengths do by r2 < h0 - r3; then alone may be larger than last without interactions.

  treb-plot importance accurate.h5                     -> accurate-importance.png
  treb-plot importance masses.h5 --field "range / r2" --at fulcrum-height=2
  treb-plot importance masses.h5 --among "(r1 > 0.5) & (r2 > 0.7)"
"""

import itertools
import math

import numpy as np

from .accessor import key_of, stem
from .backend import AXES
from .expressions import Expression
from .picture import COLOURS, add_output, check_output, labelled, readable_unit, save, set_title, with_legend, wrapped
from .program import Parser, fail
from .scenes import load, select

MOST_AXES = 12


def explained(values):
    """{axes, a tuple of numbers: share of an array's variance that they explain together}; NaN is no value."""
    every = tuple(range(values.ndim))
    count = np.isfinite(values).astype(float)
    sums = np.where(count > 0, values - np.nanmean(values), 0)
    parts = {every: (sums, count)}
    for size_ in reversed(every):
        for axes in itertools.combinations(every, size_):
            added = next(axis for axis in every if axis not in axes)
            larger = tuple(sorted((*axes, added)))
            parts[axes] = tuple(part.sum(axis=larger.index(added)) for part in parts[larger])
    variances = {axes: float(np.sum(np.divide(total ** 2, number, out=np.zeros_like(total), where=number > 0)))
                 for axes, (total, number) in parts.items()}
    return {axes: variance / variances[every] for axes, variance in variances.items()}


def shapley_effects(values):
    """(effects, alone, last): of each axis of an array."""
    shares, count = explained(values), values.ndim
    effects = np.zeros(count)
    for axes, share in shares.items():
        for axis in set(range(count)) - set(axes):
            weight = math.factorial(len(axes)) * math.factorial(count - len(axes) - 1) / math.factorial(count)
            effects[axis] += weight * (shares[tuple(sorted((*axes, axis)))] - share)
    alone = [shares[axis,] for axis in range(count)]
    last = [1 - shares[tuple(other for other in range(count) if other != axis)] for axis in range(count)]
    return effects, np.array(alone), np.array(last)


def read(archive, field, among):
    """The values of an expression, an array (outer axes..., r1, r3, r2); NaN without one, or if `among` is false."""
    def scene_values(index):
        scene = archive.data.isel(dict(zip(archive.outer, index)))
        values = field.values(scene)
        return np.where(among.flags(scene), values, np.nan) if among else values

    scenes = [scene_values(index) for index in np.ndindex(archive.outer_shape)]
    values = np.reshape(scenes, (*archive.outer_shape, *scenes[0].shape))
    return np.where(np.isfinite(values), values, np.nan)


def describe(archive, field):
    """What a field is, and its unit."""
    stored = field.text in archive.fields
    return (archive.long_name(field.text), archive.unit(field.text)) if stored else (field.text, "")


def axis_text(archive, name):
    """An axis as text."""
    values = archive.data[name].values
    return f"{key_of(name)} = {values[0]:.6g} to {values[-1]:.6g} {archive.unit(name)} ({len(values)} values)"


def report(archive, field, values, names, table):
    """Prints the designs and the shares of the axes."""
    text, unit = describe(archive, field)
    factor, unit = readable_unit(unit, np.nanmax(np.abs(values)))
    designs = int(np.isfinite(values).sum())
    rows = [("map", f"{archive.name()}: {text}"),
            *(("" if i else "axes", axis_text(archive, name)) for i, name in enumerate(names)),
            ("designs", f"{designs}, {100 * designs / int(archive.designs().sum()):.3g} % of the lattice"),
            ("values", f"mean {factor * np.nanmean(values):.6g}, standard deviation "
                       f"{factor * np.nanstd(values):.6g} {unit}".rstrip())]
    for title, words in rows:
        print(f"{title:9}{words}")
    width = max(map(len, map(key_of, names)))
    print(f"\n{'axis':{width}}   effect    alone     last")
    for name, shares in zip([*map(key_of, names), "sum"], [*zip(*table), list(map(sum, table))]):
        print(f"{name:{width}} " + " ".join(f"{share:8.6f}" for share in shares))


def draw(archive, field, names, table, designs):
    """The figure: a bar for each axis, and what it explains alone."""
    effects, alone, _ = table
    figure, ((axes,),), below = with_legend(0.16 + 0.07 * len(names), 1)
    axes.barh(range(len(names)), effects, 0.6, color=COLOURS[0], label="Shapley effect")
    for place, share in enumerate(effects):
        axes.text(1.01, place, f"{share:.3f}", va="center", transform=axes.get_yaxis_transform())
    axes.plot(alone, range(len(names)), "D", color=COLOURS[4], markeredgecolor="black", markersize=5,
              label="explained alone")
    texts = [f"{archive.short_name(name)}{f' {name}' if name in AXES else ''}" for name in names]
    axes.set_yticks(range(len(names)), [wrapped(labelled(text, archive.unit(name)), 2.2)
                                        for name, text in zip(names, texts)])
    axes.invert_yaxis()
    axes.set_xlim(min(0, *effects), 1.05 * max(*effects, *alone))
    axes.set_xlabel(f"share of the variance of the {key_of(field.text)}")
    axes.grid(True, axis="x", color="0.9")
    axes.set_axisbelow(True)
    below.legend(*axes.get_legend_handles_labels(), loc="center", ncol=2)
    set_title(figure, f"{archive.name()}: importance of the axes for the {describe(archive, field)[0]}, "
                      f"{designs} designs{'' if archive.complete else f'; {archive.progress()}'}")
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("archive", metavar="ARCHIVE",
                        help="archive of a sweep or a study with maps, or FILE.partial, an unfinished one")
    parser.add_argument("--field", default="speed", help="a map of numbers, or an expression (default: speed)")
    parser.add_scene(what="use only the scenes with this value")
    parser.add_argument("--among", metavar="EXPRESSION", help="true of the designs to consider (default: all)")
    add_output(parser, "the archive's name with -importance.png")
    arguments = parser.parse_args()

    output = arguments.output or f"{stem(arguments.archive, arguments.at)}-importance.png"
    check_output(output, arguments.archive)
    archive = select(load(arguments.archive), arguments.at)
    field = archive.expression(arguments.field)
    values = read(archive, field, arguments.among and Expression("among", arguments.among))
    names = [axis for axis in (*archive.outer, *AXES) if archive.data.sizes[axis] > 1]
    if len(names) > MOST_AXES:
        fail(f"{archive.path}: has {len(names)} axes; at most {MOST_AXES} can be examined; choose scenes with --at")
    if not np.isfinite(values).any() or np.nanmax(values) - np.nanmin(values) <= 1e-12 * np.nanmax(np.abs(values)):
        fail(f"{archive.path}: {arguments.field} is constant, or has no value, and so no variance")
    values = values.reshape([n for n in values.shape if n > 1])
    table = shapley_effects(values)
    report(archive, field, values, names, table)
    save(draw(archive, field, names, table, int(np.isfinite(values).sum())), output)
