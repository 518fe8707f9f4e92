#!/usr/bin/env python3
"""Prints and draws which axes the variance of a map comes from (Sobol indices).

The axes are r1, r3 and r2, and of a study its outer axes. All designs of a full box of the lattice
count equally, in all scenes, and the shares are exact sums over them, without sampling:

  first order  variance of the mean over all other axes: what the axis explains alone
  total        1 - what all other axes explain together: the axis with all its interactions

Each is a share of the variance in the box, and depends on the box. If no axes interact, the shares
of first order add up to 1.

The lattice is not a box, because r2 < h0 - r3, and designs without a release have no speed. The box
is the one with the most designs, all of which exist and have a value in every scene. --box gives
the range of an axis instead, whose values the box then has all; the others are found as before.

  sobol.py accurate.h5                                 -> accurate-sobol.png
  sobol.py masses.h5 --field efficiency --at fulcrum-height=2 --pairs
  sobol.py masses.h5 --box r1=0.5:0.9 --box projectile-mass=50:100
"""

from collections import namedtuple
from functools import reduce

from program import Parser, fail, interval, refuse, run  # before modules that may be missing

import numpy as np

from archive import AXES, Archive, key_of, stem
from box import largest_full_box
from picture import (OUTPUT_HELP, check_output, labelled, plt, readable_unit, save, set_title,
                     wrapped)

# A map in a full box: the values of its axes {name: values}, the map (an array over them), the most
# designs of a scene that a full box could have, and the designs of all scenes, in the box or not.
BoxedMap = namedtuple("BoxedMap", "axes values most designs")


def explained(values, axes):
    """The variance of an array's means over all axes but some, as a share of its variance."""
    others = tuple(axis for axis in range(values.ndim) if axis not in axes)
    centred = values - values.mean()
    return float((centred.mean(axis=others) ** 2).mean() / (centred ** 2).mean())


def first_order(values):
    """The shares of first order of the axes of an array."""
    return [explained(values, [axis]) for axis in range(values.ndim)]


def totals(values):
    """The total shares of the axes of an array."""
    return [1 - explained(values, [other for other in range(values.ndim) if other != axis])
            for axis in range(values.ndim)]


def second_order(values):
    """{(a, b): share} of the interaction of each two axes of an array."""
    single = first_order(values)
    return {(a, b): explained(values, [a, b]) - single[a] - single[b]
            for b in range(values.ndim) for a in range(b)}


def common_lattice(archive):
    """The indices of the values of r1 that all scenes have, and the rows of r2 that they share, as
    in Lattice."""
    lattices = [archive.lattices[n] for n in np.unique(archive.lattice_of.ravel()[archive.scenes])]
    r1 = reduce(np.intersect1d, [lattice.own[0] for lattice in lattices])
    rows = np.min([lattice.rows for lattice in lattices], axis=0)
    if not r1.size or not rows.any():
        fail(f"{archive.path}: no design is in the lattices of all scenes; choose scenes with --at "
             f"or --box")
    return r1, rows


def chosen_indices(archive, ranges, r1, rows):
    """The indices of the values of r1, r3, r2 in which to look for the box."""
    indices = [r1, np.flatnonzero(rows), np.arange(rows.max())]
    for axis, name in enumerate(AXES):
        if name in ranges:
            indices[axis] = np.intersect1d(indices[axis],
                                           archive.indices_between(name, *ranges[name]))
    return indices


def read_scene(scene, field, indices):
    """A map of a scene at indices of the archive's r1, r3, r2."""
    (r1, r3, r2), own = indices, scene.lattice.own[0]
    return scene.read(field, (np.searchsorted(own, r1), slice(r3[0], r3[-1] + 1),
                              slice(r2[0], r2[-1] + 1)))


def find_box(archive, field, ranges):
    """The indices of r1, r3, r2 in the largest full box, and the most designs that one can have."""
    r1, rows = common_lattice(archive)
    indices = chosen_indices(archive, ranges, r1, rows)
    if not all(index.size for index in indices):
        fail(f"{archive.path}: no design in the ranges of --box is in the lattices of all scenes")
    finite = rows[indices[1], np.newaxis] > indices[2]
    finite = np.broadcast_to(finite, [len(index) for index in indices]).copy()
    rows = finite[0].sum(axis=1)
    for scene in archive.each_scene():
        has_value = np.isfinite(read_scene(scene, field, indices))
        if not has_value.any():
            fail(f"{scene.name()}: no design has a {key_of(field)} there; choose other "
                 f"scenes with --at or --box")
        finite &= has_value
    fixed = [axis for axis, name in enumerate(AXES) if name in ranges]
    for axis in fixed:  # all of its values or none
        finite = finite.all(axis=axis, keepdims=True)
    if 1 in fixed:
        rows = rows[-1:]
    if 2 in fixed:
        rows = (rows == len(indices[2])).astype(int)
    box = largest_full_box(finite, rows)
    if box is None:
        fail(f"{archive.path}: no box has a {key_of(field)} in every design of every "
             f"scene; give --box other ranges, or choose scenes with --at")
    found = [index if axis in fixed else index[slice(*ends)] for axis, (index, ends) in enumerate(
        zip(indices, zip(box.lower, box.upper)))]
    return found, box.most * int(np.prod([len(indices[axis]) for axis in fixed]))


def read_box(archive, field, ranges):
    """The BoxedMap of a field, with the ranges of some axes given."""
    for name, (first, last) in ranges.items():
        if name in archive.outer_axes:
            archive = archive.between(name, first, last)
    found, most = find_box(archive, field, ranges)
    values = np.array([read_scene(scene, field, found) for scene in archive.each_scene()], float)
    axes = {**archive.outer_axes,
            **{name: archive.box[name][index] for name, index in zip(AXES, found)}}
    sizes = np.array([len(lattice.own[0]) * lattice.rows.sum() for lattice in archive.lattices])
    designs = int(sizes[archive.lattice_of.ravel()[archive.scenes]].sum())
    return BoxedMap(axes, values.reshape([len(x) for x in axes.values()]), most, designs)


def range_text(archive, name, values):
    """An axis of the box as text."""
    ends = f"{values[0]:.6g}" + (f" to {values[-1]:.6g}" if len(values) > 1 else "")
    text = f"{key_of(name)} = {ends} {archive.unit(name)}".rstrip()
    return f"{text} ({len(values)} values)" if len(values) > 1 else text


def extent_text(boxed, ranges):
    """How large the box is, as text."""
    given = [name for name in AXES if name in ranges]
    text = "the full box with the most designs"
    if len(given) == len(AXES):
        return "as given; every design has a value"
    if given:
        text += f" for the given {' and '.join(given)}"
    designs = int(np.prod([len(boxed.axes[name]) for name in AXES]))
    return text if designs == boxed.most else \
        f"perhaps not {text}: {designs} per scene, at most {boxed.most} are possible"


def print_box(archive, field, boxed, ranges):
    """Describes the box and the values in it."""
    values, unit = boxed.values, archive.unit(field)
    factor, unit = readable_unit(unit, np.abs(values).max())
    rows = [("map", f"{archive.name()}: {archive.long_name(field)}"),
            *(("box" if i == 0 else "", range_text(archive, *axis))
              for i, axis in enumerate(boxed.axes.items())), ("", extent_text(boxed, ranges)),
            ("designs", f"{values.size}, {100 * values.size / boxed.designs:.3g} % of the "
                        f"{'lattices' if archive.in_study else 'lattice'}"),
            ("values", f"mean {factor * values.mean():.6g}, standard deviation "
                       f"{factor * values.std():.6g} {unit}".rstrip())]
    for title, text in rows:
        print(f"{title:9}{text}")


def print_shares(names, singles, whole, pairs):
    """Prints the shares of the axes, and of pairs of them."""
    width = max(len(key_of(name)) for name in (*names, "axis"))
    if pairs:
        width = max(width, *(len(f"{key_of(names[a])}, {key_of(names[b])}") for a, b in pairs))
    print(f"\n{'axis':{width}}  first order    total")
    for name, one, all_ in zip(names, singles, whole):
        print(f"{key_of(name):{width}}  {one:11.6f} {all_:8.6f}")
    print(f"{'sum':{width}}  {sum(singles):11.6f} {sum(whole):8.6f}")
    if pairs:
        print(f"\n{'pair':{width}} second order")
        for (a, b), share in pairs.items():
            print(f"{key_of(names[a]) + ', ' + key_of(names[b]):{width}}  {share:11.6f}")
        print(f"{'sum':{width}}  {sum(pairs.values()):11.6f}")


def draw(archive, field, boxed, names, singles, whole):
    """The figure: two bars for each axis."""
    figure, axes = plt.subplots(figsize=(9, 2 + 0.8 * len(names)))
    places = np.arange(len(names))
    for shares, label, colour, offset in ((singles, "first order", "#0072B2", -0.2),
                                          (whole, "total", "#E69F00", 0.2)):
        bars = axes.barh(places + offset, shares, 0.38, label=label, color=colour)
        axes.bar_label(bars, [f"{share:.3f}" for share in shares], padding=3)
    texts = [f"{archive.short_name(name)} {name}" if name in AXES else archive.short_name(name)
             for name in names]
    labels = [wrapped(labelled(text, archive.unit(name)), 3.5, 10)
              for name, text in zip(names, texts)]
    axes.set_yticks(places, labels)
    axes.invert_yaxis()
    axes.set_xlim(0, 1.12 * max(*whole, *singles))
    axes.set_xlabel(f"share of the variance of the {key_of(field)}")
    axes.grid(True, axis="x", color="0.9")
    axes.set_axisbelow(True)
    axes.legend(loc="best")
    box = ", ".join(range_text(archive, *axis) for axis in boxed.axes.items())
    title = f"{archive.name()}: variance of the {key_of(field)} by axis, in the box"
    set_title(figure, f"{title}\n{box}")
    return figure


def read_ranges(archive, given):
    """{name: (first, last)} of the ranges in --box."""
    ranges = {}
    for key, ends in given:
        name = key.replace("-", "_")
        axes = [*archive.outer_axes, *AXES]
        if name not in axes or name in ranges:
            refuse("box", f"{key}={':'.join(f'{end:g}' for end in ends)}",
                   f"must name an axis, each once: {', '.join(map(key_of, axes))}")
        ranges[name] = ends
    return ranges


def main():
    parser = Parser(__doc__)
    parser.add_argument("archive", metavar="ARCHIVE",
                        help="archive of a sweep or a study with maps, or FILE.partial, an unfinished one")
    parser.add_argument("--field", default="speed", help="the map of numbers (default: speed)")
    parser.add_scene(what="use only the scenes with this value")
    parser.add_argument("--box", metavar="KEY=FIRST:LAST", type=interval, action="append",
                        default=[], help="the range of an axis in the box; once per axis")
    parser.add_argument("--pairs", action="store_true",
                        help="also print the shares of second order: the interaction of two axes")
    parser.add_argument("-o", "--output", metavar="PICTURE",
                        help=OUTPUT_HELP + "default: the archive's name with -sobol.png")
    arguments = parser.parse_args()

    output = arguments.output or f"{stem(arguments.archive, arguments.at)}-sobol.png"
    check_output(output, arguments.archive)
    archive = Archive(arguments.archive).select(arguments.at)
    field = archive.number_field(arguments.field)
    ranges = read_ranges(archive, arguments.box)
    boxed = read_box(archive, field, ranges)
    print_box(archive, field, boxed, ranges)
    names = [name for name, values in boxed.axes.items() if len(values) > 1]
    values = boxed.values.squeeze()
    if np.ptp(values) <= 1e-12 * np.abs(values).max():
        fail(f"{arguments.archive}: {arguments.field} is constant in the box, and has no variance")
    singles, whole = first_order(values), totals(values)
    print_shares(names, singles, whole, second_order(values) if arguments.pairs else {})
    save(draw(archive, field, boxed, names, singles, whole), output)


if __name__ == "__main__":
    run(main)
