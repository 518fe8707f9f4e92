#!/usr/bin/env python3
"""Draws a map of an archive: its three planes through the optimum.

What is outside the lattice stays blank; a star marks the optimum. A plane of your own choice:
--r1 0.7. The format follows the suffix of the picture (png, svg, pdf).
"""

import argparse
import os

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap

from archive import AXES, Archive, edges, plt, save

# The planes: (fixed axis, horizontal axis, vertical axis).
PLANES = (("r1", "r2", "r3"), ("r3", "r2", "r1"), ("r2", "r3", "r1"))

FIXED_STEPPERS = ("euler", "modified_midpoint", "rk4", "adams_bashforth_moulton")


def plane(archive, field, fixed, index, horizontal, vertical):
    """The values of a map at axis `fixed` = its value number `index`, as (vertical, horizontal)."""
    where = tuple(index if name == fixed else slice(None) for name in AXES)
    values = archive.map(field)[where]
    left = [name for name in AXES if name != fixed]
    return values if left == [vertical, horizontal] else values.T


def flag_colours(archive, field):
    """Colours, their norm and the meanings of a map of flags, for the values that are not blank."""
    attributes = archive.map(field).attrs
    meanings = str(attributes["flag_meanings"]).split()
    colours = ListedColormap(["white", *plt.get_cmap("Set2").colors[: len(meanings) - 1]])
    return colours, BoundaryNorm(np.arange(len(meanings) + 1) - 0.5, len(meanings)), meanings


def planes(archive, field, centre):
    """The values of a map in its PLANES through `centre` ({axis: m})."""
    return [plane(archive, field, fixed, archive.index(fixed, centre[fixed]), *rest)
            for fixed, *rest in PLANES]


def draw_values(axes, archive, centre, axis_names, values, **style):
    """Draws the values of one plane; returns their colours, for the colour bar."""
    fixed, horizontal, vertical = axis_names
    mesh = axes.pcolormesh(edges(archive.axes[horizontal]), edges(archive.axes[vertical]), values,
                           rasterized=True, **style)
    axes.set_xlabel(archive.label(horizontal))
    axes.set_ylabel(archive.label(vertical))
    axes.set_title(f"{fixed} = {archive.axes[fixed][archive.index(fixed, centre[fixed])]:g} m")
    return mesh


def draw_plane(axes, archive, centre, axis_names, values, style):
    """The same with contours and the optimum."""
    fixed, horizontal, vertical = axis_names
    mesh = draw_values(axes, archive, centre, axis_names, values, **style)
    is_number = values.dtype.kind == "f"
    if is_number and min(values.shape) > 1 and np.isfinite(values).any():
        lines = axes.contour(archive.axes[horizontal], archive.axes[vertical], values, 8,
                             colors="white", linewidths=0.6, alpha=0.8)
        axes.clabel(lines, fontsize=7, fmt="%g")
    optimum = archive.optimum()
    if optimum and archive.index(fixed, optimum[fixed]) == archive.index(fixed, centre[fixed]):
        axes.plot(optimum[horizontal], optimum[vertical], "*", color="red", markersize=13,
                  markeredgecolor="white", label="fastest", clip_on=False)
    return mesh


def finite_values(parts):
    """The finite numbers of some planes."""
    return np.concatenate([part[np.isfinite(part)] for part in parts])


def title(archive, field):
    """What is drawn and how it was computed."""
    job = archive.job()
    name = os.path.splitext(os.path.basename(archive.path))[0]
    text = f"{name}: {archive.map(field).attrs['long_name']}"
    stepper = job.get(("solver", "stepper"))
    if stepper:
        setting = "time-step" if stepper in FIXED_STEPPERS else "tolerance"
        text += f" ({stepper}, {setting.replace('-', ' ')} {job['solver', setting]}"
        text += " s)" if setting == "time-step" else ")"
    return f"{text}\nfastest: {archive.best()}"


def draw(archive, field, centre):
    """The figure with the three planes through `centre` ({axis: m})."""
    figure, panels = plt.subplots(1, 3, figsize=(15, 5.2), constrained_layout=True)
    parts = planes(archive, field, centre)
    is_number = archive.map(field).dtype.kind == "f"
    if is_number:  # all share one scale
        values = finite_values(parts)
        low, high = (values.min(), values.max()) if values.size else (0, 1)
        style = {"cmap": "viridis", "vmin": low, "vmax": high}
    else:
        colours, norm, meanings = flag_colours(archive, field)
        style = {"cmap": colours, "norm": norm}
    for axes, names, part in zip(panels, PLANES, parts):
        mesh = draw_plane(axes, archive, centre, names, part, style)
    bar = figure.colorbar(mesh, ax=panels, pad=0.01)
    if is_number:
        bar.set_label(archive.label(field.replace("-", "_")))
    else:
        bar.set_ticks(range(len(meanings)), labels=[word.replace("_", " ") for word in meanings])
    figure.suptitle(title(archive, field))
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("archive", help="archive of a sweep")
    parser.add_argument("--field", help="the map to draw (default: speed, or else the first)")
    for axis in AXES:
        parser.add_argument(f"--{axis}", type=float, metavar="M",
                            help=f"draw the plane at this {axis} (default: the optimum's)")
    parser.add_argument("-o", "--output", metavar="PICTURE",
                        help="default: the archive's name with the field's and .png")
    arguments = parser.parse_args()

    archive = Archive(arguments.archive)
    middle = {name: values[len(values) // 2] for name, values in archive.axes.items()}
    centre = archive.optimum() or middle
    centre.update({name: getattr(arguments, name) for name in AXES
                   if getattr(arguments, name) is not None})
    field = arguments.field or ("speed" if "speed" in archive.fields else archive.fields[0])
    output = arguments.output or f"{os.path.splitext(arguments.archive)[0]}-{field}.png"
    save(draw(archive, field, centre), output)


if __name__ == "__main__":
    main()
