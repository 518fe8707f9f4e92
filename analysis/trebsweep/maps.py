"""Draws maps of an archive: a lattice with three free axes as three planes, with two as one plane,
with one as a line."""

import numpy as np

from .accessor import edges
from .backend import AXES
from .picture import POINTS, labelled, plt, readable_unit, set_title, size, wrapped

# The planes: (fixed axis, horizontal axis, vertical axis).
PLANES = (("r1", "r2", "r3"), ("r3", "r2", "r1"), ("r2", "r3", "r1"))


def views(archive):
    """The axes of each panel, (horizontal, vertical) or (horizontal,); none for a single design."""
    free = archive.free_axes
    if len(free) < 2:
        return [tuple(free)] if free else []
    return [names for fixed, *names in PLANES if set(names) <= set(free)]


def middle(archive):
    """{axis: m} of the middle of each axis."""
    return {name: float(values[len(values) // 2]) for name, values in archive.axes.items()}


def slices(archive, field, centre):
    """Arrays (vertical, horizontal) of a map's values in each view through `centre` ({axis: m})."""
    return [archive.section(field, list(reversed(names)), centre).values for names in views(archive)]


def finite_values(values):
    """The finite values of several arrays, as one array."""
    return np.concatenate([part[np.isfinite(part)] for part in values])


def flag_colours(meanings):
    """Colour map and norm of flags; the flag 0 is blank."""
    colours = ["white", *plt.get_cmap("Set3").colors[: len(meanings) - 1]]
    limits = np.arange(len(meanings) + 1) - 0.5
    return {"cmap": plt.matplotlib.colors.ListedColormap(colours),
            "norm": plt.matplotlib.colors.BoundaryNorm(limits, len(meanings))}


def axis_label(archive, name):
    """The label of an axis of the lattice."""
    return wrapped(labelled(f"{archive.long_name(name)} {name}", archive.unit(name)), 1.9)


def position_text(archive, names, centre):
    """The values of the axes that a view of the axes `names` holds fixed, as text."""
    fixed = [name for name in AXES if name not in names]
    values = [archive.axes[name][archive.nearest(name, centre[name])] for name in fixed]
    return ", ".join(f"{name} = {value:g}" for name, value in zip(fixed, values)) + " m"


def shows(archive, names, centre, design):
    """Whether a view of the axes `names` through `centre` contains the design."""
    return all(archive.nearest(name, design[name]) == archive.nearest(name, centre[name])
               for name in AXES if name not in names)


def contour_levels(values):
    """Round levels for the contours of several arrays; none if the values are constant."""
    finite = finite_values(values)
    if not finite.size or np.ptp(finite) <= 1e-9 * np.abs(finite).max():
        return []
    return plt.MaxNLocator(9, min_n_ticks=1).tick_values(finite.min(), finite.max())


def draw_contours(axes, archive, names, values, levels, norm):
    """Draws the contours of the levels, black on bright colours."""
    if min(values.shape) < 2 or not any(np.nanmin(values) < level < np.nanmax(values)
                                        for level in levels):
        return
    lines = axes.contour(*(archive.axes[name] for name in names), values, levels, linewidths=0.6,
                         colors=["white" if norm(level) < 0.5 else "black" for level in levels])
    axes.clabel(lines, fontsize=POINTS, fmt="%g")


def draw_plane(axes, archive, names, values, style, levels):
    """Draws the values of a plane, with contours of some levels; returns the mesh, for the colour
    bar."""
    limits = [edges(archive.axes[name]) for name in names]
    mesh = axes.pcolormesh(*limits, values, rasterized=True, **style)
    draw_contours(axes, archive, names, values, levels, mesh.norm)
    shown = values != 0 if values.dtype.kind == "u" else np.isfinite(values)
    ends = [within(edge, shown.any(axis=axis)) for axis, edge in enumerate(limits)]
    axes.set(xlim=ends[0], ylim=ends[1], ylabel=axis_label(archive, names[1]))
    return mesh


def within(limits, shown):
    """The first and the last boundary of the cells that hold something, else of all."""
    cells = np.flatnonzero(shown) if shown.any() else np.arange(len(shown))
    return limits[cells[0]], limits[cells[-1] + 1]


def draw_line(axes, archive, name, values, style, meanings):
    """Draws the values along an axis."""
    marker = "o" if meanings or len(values) < 50 else ""
    axes.plot(archive.axes[name], values, marker=marker, markersize=4,
              linestyle="none" if meanings else "-", color="tab:blue")
    axes.grid(True, color="0.9")
    if meanings:
        axes.set_ylim(-0.5, len(meanings) - 0.5)
    if isinstance(style.get("norm"), plt.matplotlib.colors.LogNorm):
        axes.set_yscale("log")


def draw(archive, values, centre, title, label, style, meanings=(), star=None, star_colour="red",
         background="white", contours=False):
    """The figure of a map.

    values    arrays of each view through `centre` ({axis: m}), from slices()
    label     description of the values, with their unit
    style     colour map and norm, as arguments of pcolormesh
    meanings  texts of the flags, if the values are flags
    star      {axis: m} of the design to mark, or None
    contours  whether to draw contours, of the same levels in all views
    """
    panels = views(archive)
    figure, all_axes = plt.subplots(1, len(panels), squeeze=False,
                                    figsize=size(0.42 if len(panels) > 1 else 0.6))
    label = wrapped(label, figure.get_figheight() - 0.8)
    levels = contour_levels(values) if contours else []
    for axes, names, part in zip(all_axes.flat, panels, values):
        axes.set_facecolor(background if len(names) > 1 else "white")
        axes.set_title(position_text(archive, names, centre))
        axes.set_xlabel(axis_label(archive, names[0]))
        lengths = archive.axes[names[0]]
        if np.ptp(lengths) < 0.02 * lengths[-1]:  # its labels have many digits
            axes.xaxis.set_major_locator(plt.MaxNLocator(1 if len(panels) > 1 else 4))
        marked = star is not None and shows(archive, names, centre, star)
        if len(names) == 1:
            draw_line(axes, archive, *names, part, style, meanings)
            scale = axes.yaxis
            axes.set_ylabel(label)
            point = marked and (star[names[0]],
                                part[archive.nearest(names[0], star[names[0]])])
        else:
            mesh = draw_plane(axes, archive, names, part, style, levels)
            point = marked and tuple(star[name] for name in names)
        if point:
            axes.plot(*point, "*", color=star_colour, markersize=10, markeredgecolor="white",
                      clip_on=False, zorder=3)
    if len(panels[0]) > 1:
        bar = figure.colorbar(mesh, ax=all_axes, pad=0.01)
        bar.set_label("" if meanings else label)
        if isinstance(mesh.norm, plt.matplotlib.colors.SymLogNorm):  # ticks near zero would overlap
            bar.set_ticks([t for t in bar.get_ticks()
                           if t == 0 or mesh.norm.linthresh <= abs(t) <= mesh.norm.vmax])
        scale = bar
    if meanings:
        scale.set_ticks(range(len(meanings)), labels=meanings)
    set_title(figure, title)
    return figure


def scaled(archive, field, values):
    """The values of a map's views converted to a readable unit, and this unit."""
    finite = finite_values(values)
    largest = np.abs(finite).max() if finite.size else 0
    factor, unit = readable_unit(archive.unit(field), largest)
    return [factor * part for part in values], unit
