#!/usr/bin/env python3
"""Compares a map of two archives of the same lattice: A - B, in numbers and as a picture.

The numbers go to stdout: the optimum of each archive, the number of designs with a value in both,
and the median, 95th percentile and maximum of the difference. The picture shows the planes through
B's optimum, marked by a star. Designs without a value in one of the archives are left blank.

To compare the paper's Euler sweep with an accurate one:

  compare.py paper.h5 accurate.h5                      -> paper-accurate.png
"""

from program import Parser, fail, note, refuse, run  # before modules that may be missing

import numpy as np

from archive import AXES, Archive, design_text, stem
from maps import draw, finite_values, middle, scaled, slices, views
from picture import OUTPUT_HELP, check_output, labelled, readable_unit, save


def check_lattices(a, b):
    """Ends the program unless both archives have the same axes."""
    for name in AXES:
        x, y = a.axes[name], b.axes[name]
        if len(x) != len(y) or not np.allclose(x, y, rtol=1e-12):
            fail(f"{a.path} and {b.path} have different lattices: {name} runs over {len(x)} values "
                 f"from {x[0]:g} to {x[-1]:g} m and {len(y)} values from {y[0]:g} to {y[-1]:g} m")


def report(a, b, field):
    """Prints statistics of the difference."""
    x, y = (archive.read(field).astype(float) for archive in (a, b))
    both = np.isfinite(x) & np.isfinite(y)
    only = int((np.isfinite(x) != np.isfinite(y)).sum())
    print(f"A         {a.path}: {a.best_text()}")
    print(f"B         {b.path}: {b.best_text()}")
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
    factor, unit = readable_unit(a.unit(field), max(abs(x[worst]), abs(y[worst])))
    print(f"largest   at {design_text(a.design(indices[worst]))}: {factor * x[worst]:.12g} against "
          f"{factor * y[worst]:.12g} {unit}".rstrip())


def picture(a, b, field):
    """The figure of A - B in the planes through the optimum of B."""
    optimum = b.optimum()
    centre = optimum[0] if optimum else middle(b)
    values = [x.astype(float) - y
              for x, y in zip(slices(a, field, centre), slices(b, field, centre))]
    values, unit = scaled(a, field, values)
    finite = finite_values(values)
    limit = np.abs(finite).max() if finite.size and finite.any() else 1
    title = f"difference \u201c{a.name()}\u201d \u2212 \u201c{b.name()}\u201d, " + (
        f"\u2605 {b.best_word()} of \u201c{b.name()}\u201d" if optimum else "middle of the lattice")
    title += "".join(f"\n\u201c{archive.name()}\u201d {archive.progress()}" for archive in (a, b)
                     if not archive.complete)
    return draw(a, values, centre, title, labelled(f"difference of the {a.long_name(field)}", unit),
                {"cmap": "RdBu_r", "vmin": -limit, "vmax": limit},
                star=optimum and optimum[0], star_colour="black", background="0.93")


def main():
    parser = Parser(__doc__)
    parser.add_argument("a", metavar="A", help="archive")
    parser.add_argument("b", metavar="B", help="archive to compare with")
    parser.add_argument("--field", default="speed",
                        help="the map of numbers to compare (default: speed)")
    parser.add_argument("-o", "--output", metavar="PICTURE",
                        help=OUTPUT_HELP + "default: A-B.png in the directory of A")
    arguments = parser.parse_args()

    output = arguments.output or f"{stem(arguments.a)}-{stem(arguments.b).rsplit('/', 1)[-1]}.png"
    check_output(output, arguments.a, arguments.b)
    a, b = Archive(arguments.a), Archive(arguments.b)
    check_lattices(a, b)
    field = a.field(arguments.field)
    b.field(arguments.field)
    if not (a.is_number(field) and b.is_number(field)):
        numbers = ", ".join(name for name in a.fields if a.is_number(name))
        refuse("field", arguments.field, f"holds flags; must be a map of numbers: {numbers}")
    report(a, b, field)
    if views(a):
        save(picture(a, b, field), output)
    else:
        note(f"{a.path}: holds a single design; no picture is drawn")


if __name__ == "__main__":
    run(main)
