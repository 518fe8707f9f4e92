#!/usr/bin/env python3
"""Compares a map of two archives of one lattice: A - B, in numbers and as a picture.

For example the paper's Euler sweep against an accurate one:
    analysis/compare.py paper.h5 accurate.h5
"""

import argparse
import os
import sys

import numpy as np

from archive import AXES, Archive, design_text, plt, save, unit_text
from heatmap import PLANES, draw_values, finite_values, planes


def check_lattices(a, b):
    """Ends the program unless both archives have the same axes."""
    for name in AXES:
        x, y = a.axes[name], b.axes[name]
        if len(x) != len(y) or not np.allclose(x, y, rtol=1e-12):
            sys.exit(f"{a.path} and {b.path} have different lattices: {name} runs over "
                     f"{len(x)} values from {x[0]:g} to {x[-1]:g} m and {len(y)} values from "
                     f"{y[0]:g} to {y[-1]:g} m")


def report(a, b, field):
    """Prints the difference of the archives in numbers."""
    x, y = a.map(field)[...], b.map(field)[...]
    both = np.isfinite(x) & np.isfinite(y)
    only = int((np.isfinite(x) != np.isfinite(y)).sum())
    print(f"A         {a.path}: {a.best()}")
    print(f"B         {b.path}: {b.best()}")
    print(f"designs   {int(both.sum())} with a {field} in both, {only} in one of them only")
    if not both.any():
        return
    difference = np.where(both, x - y, 0)
    size = np.abs(difference[both])
    relative = difference[both] / np.maximum(np.abs(y[both]), np.finfo(float).tiny)
    unit = unit_text(a.map(field).attrs.get("units", ""))
    print(f"|A - B|   median {np.median(size):.6g}, 95 % below {np.percentile(size, 95):.6g}, "
          f"largest {size.max():.6g} {unit}")
    print(f"relative  median {100 * np.median(relative):+.4g} % "
          f"(of its size {100 * np.median(np.abs(relative)):.4g} %), "
          f"largest {100 * np.abs(relative).max():.4g} %")
    worst = np.unravel_index(np.argmax(np.abs(difference)), difference.shape)
    design = {name: a.axes[name][i] for name, i in zip(AXES, worst)}
    print(f"largest   at {design_text(design)}: {x[worst]:.12g} against {y[worst]:.12g} {unit}")


def draw(a, b, field, centre):
    """The figure of A - B in the three planes through `centre` ({axis: m})."""
    figure, panels = plt.subplots(1, 3, figsize=(15, 5.2), constrained_layout=True)
    parts = [x - y for x, y in zip(planes(a, field, centre), planes(b, field, centre))]
    finite = finite_values(parts)
    limit = np.abs(finite).max() if finite.size and finite.any() else 1
    for axes, part, names in zip(panels, parts, PLANES):
        mesh = draw_values(axes, a, centre, names, part, cmap="RdBu_r", vmin=-limit, vmax=limit)
        _, horizontal, vertical = names
        axes.plot(centre[horizontal], centre[vertical], "*", color="black", markersize=11,
                  markeredgecolor="white")
        axes.set_facecolor("0.93")
    bar = figure.colorbar(mesh, ax=panels, pad=0.01)
    bar.set_label("difference of the " + a.label(field))
    names = [os.path.splitext(os.path.basename(archive.path))[0] for archive in (a, b)]
    figure.suptitle(f"difference \u201c{names[0]}\u201d \u2212 \u201c{names[1]}\u201d, "
                    f"through the optimum of \u201c{names[1]}\u201d")
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("a", metavar="A", help="archive")
    parser.add_argument("b", metavar="B", help="archive to hold it against")
    parser.add_argument("--field", default="speed", help="the map to compare (default: speed)")
    parser.add_argument("-o", "--output", metavar="PICTURE", help="default: A-B.png beside A")
    arguments = parser.parse_args()

    a, b = Archive(arguments.a), Archive(arguments.b)
    field = arguments.field.replace("-", "_")
    check_lattices(a, b)
    if a.map(field).dtype.kind != "f" or b.map(field).dtype.kind != "f":
        sys.exit(f"{field}: holds flags, not numbers; choose another field")
    report(a, b, field)
    centre = b.optimum() or {name: values[len(values) // 2] for name, values in b.axes.items()}
    name = os.path.splitext(os.path.basename(arguments.b))[0]
    save(draw(a, b, field, centre),
         arguments.output or f"{os.path.splitext(arguments.a)[0]}-{name}.png")


if __name__ == "__main__":
    main()
