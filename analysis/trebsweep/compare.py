"""Compares a map of two archives: A - B, in numbers and as a picture.

The numbers go to stdout: the optimum of each archive, the number of designs with a value in both,
and the median, 95th percentile and maximum of the difference. The picture shows the planes through
B's optimum, marked by a star. Designs without a value in one of the archives are left blank. If the
lattices differ, the designs that both have are compared.

To compare the paper's Euler sweep with an accurate one:

  treb-plot compare paper.h5 accurate.h5                      -> paper-accurate.png

Two scenes of a study, of which B has the fulcrum height of A:

  treb-plot compare study.h5 study.h5 --at projectile-mass=100 --at fulcrum-height=2 \
             --at-b projectile-mass=200
"""

import os

import numpy as np
import pandas

from .accessor import design_text, edges, stem
from .backend import AXES
from .maps import draw, finite_values, middle, scaled, slices, views
from .picture import add_output, check_output, labelled, readable_unit, save
from .program import Parser, fail, note
from .scenes import load, only


def chosen(at, archive, other):
    """The pairs (key, value) of --at for one of two archives: all but those of axes that only the
    other one has, and none for an archive of one scene if the other one is a study."""
    if other.in_study and not archive.in_study:
        return []
    return [(key, value) for key, value in at if key.replace("-", "_") in archive.outer
            or key.replace("-", "_") not in other.outer]


def open_scenes(arguments):
    """The scenes A and B, and the map to compare."""
    a, b = load(arguments.a), load(arguments.b)
    field = a.number_field(arguments.field)
    b.number_field(arguments.field)
    changed = [key for key, _ in arguments.at_b]
    at_b = [pair for pair in chosen(arguments.at, b, a) if pair[0] not in changed]
    return only(a, chosen(arguments.at, a, b)), only(b, [*at_b, *arguments.at_b], "at-b"), field


def common_lattice(a, b):
    """The scenes with only those values of r1, r3 and r2 that both have, and whether both have the
    design, an array over these. If the lattices differ, prints how many designs both have."""
    indices = {name: pandas.Index(b.axes[name]).get_indexer(a.axes[name], "nearest", tolerance=1e-11)
               for name in AXES}
    common = [a.data.isel({name: np.flatnonzero(index >= 0) for name, index in indices.items()}).treb,
              b.data.isel({name: index[index >= 0] for name, index in indices.items()}).treb]
    all_a, all_b = (int(archive.designs().sum()) for archive in (a, b))
    both = np.logical_and(*(archive.designs().values for archive in common))
    if not both.any():
        fail(f"{a.with_scene(a.path)} and {b.with_scene(b.path)} have no design in common")
    if both.sum() < max(all_a, all_b):
        print(f"lattices  {both.sum()} designs in common, of {all_a} of A and {all_b} of B")
    return *common, both


def report(a, b, field, common):
    """Prints statistics of the difference between the designs that both scenes have."""
    x, y = (archive.data[field].values.astype(float) for archive in (a, b))
    both = np.isfinite(x) & np.isfinite(y)
    only = int((common & (np.isfinite(x) != np.isfinite(y))).sum())
    print(f"designs   {int(both.sum())} with a {field} in both, {only} in one of them only")
    if not both.any():
        return
    indices = np.argwhere(both)
    x, y = x[both], y[both]
    difference = x - y
    size = np.abs(difference)
    factor, unit = readable_unit(a.unit(field), size.max())
    print(f"|A - B|   median {factor * np.median(size):.6g}, "
          f"95 % below {factor * np.percentile(size, 95):.6g}, "
          f"largest {factor * size.max():.6g} {unit}".rstrip())
    if (y != 0).any():
        relative = 100 * difference[y != 0] / y[y != 0]
        print(f"relative  median {np.median(relative):+.4g} %, median magnitude {np.median(np.abs(relative)):.4g} %, "
              f"largest {np.abs(relative).max():.4g} %")
    worst = np.argmax(size)
    design = {name: a.axes[name][i] for name, i in zip(AXES, indices[worst])}
    factor, unit = readable_unit(a.unit(field), max(abs(x[worst]), abs(y[worst])))
    print(f"largest   at {design_text(design)}: {factor * x[worst]:.12g} against "
          f"{factor * y[worst]:.12g} {unit}".rstrip())


def optimum_within(archive):
    """{axis: m} of the optimum of a scene, or None if it lies outside the archive's axes."""
    optimum = archive.optimum()
    inside = optimum and all(limits[0] <= optimum[0][name] <= limits[-1] for name, limits in (
        (name, edges(values)) for name, values in archive.axes.items()))
    return optimum[0] if inside else None


def picture(a, b, field):
    """The figure of A - B in the planes through the optimum of B, or the middle of the lattice."""
    star = optimum_within(b)
    centre = star or middle(b)
    values = [x.astype(float) - y
              for x, y in zip(slices(a, field, centre), slices(b, field, centre))]
    values, unit = scaled(a, field, values)
    finite = finite_values(values)
    limit = np.abs(finite).max() if finite.size and finite.any() else 1
    title = f"difference \u201c{a.name()}\u201d \u2212 \u201c{b.name()}\u201d, " + (
        f"\u2605 {b.best_word()} of \u201c{b.name()}\u201d" if star else "middle of the lattice")
    title += "".join(f"\n\u201c{archive.name()}\u201d {archive.progress()}" for archive in (a, b)
                     if not archive.complete)
    return draw(a, values, centre, title, labelled(f"difference of the {a.long_name(field)}", unit),
                {"cmap": "RdBu_r", "vmin": -limit, "vmax": limit},
                star=star, star_colour="black", background="0.93")


def main():
    parser = Parser(__doc__)
    parser.add_argument("a", metavar="A", help="archive")
    parser.add_argument("b", metavar="B", help="archive to compare with")
    parser.add_argument("--field", default="speed",
                        help="the map of numbers to compare (default: speed)")
    parser.add_scene(what="the scene to read from the archives that are studies")
    parser.add_scene("--at-b", "replaces the value of --at in B")
    add_output(parser, "A-B.png in the directory of A")
    arguments = parser.parse_args()

    output = arguments.output or (
        f"{stem(arguments.a, arguments.at)}-"
        f"{stem(os.path.basename(arguments.b), arguments.at_b)}.png")
    check_output(output, arguments.a, arguments.b)
    a, b, field = open_scenes(arguments)
    for name, archive in (("A", a), ("B", b)):
        print(f"{name}         {archive.with_scene(archive.path)}: {archive.best_text()}")
    a, b, common = common_lattice(a, b)
    report(a, b, field, common)
    if views(a):
        save(picture(a, b, field), output)
    else:
        note(f"{a.path}: holds a single design; no picture is drawn")
