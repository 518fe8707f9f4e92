"""Technical drawings: shapes with dimensions, as a picture or as a DXF file.

Coordinates and lengths are in m, y points up. A shape has a layer, which is its colour in pictures.
"""

from collections import namedtuple

import numpy as np
from matplotlib.path import Path

Line = namedtuple("Line", "layer points")             # a path of (x, y)
Circle = namedtuple("Circle", "layer centre radius")
Square = namedtuple("Square", "layer centre side")
# A distance, drawn `offset` m to the left of the way from `first` to `last`.
Dimension = namedtuple("Dimension", "first last offset text")
# The angle at a corner, counterclockwise from the direction of `first` to that of `last`, rad from the x axis.
Angle = namedtuple("Angle", "corner first last radius text")
Label = namedtuple("Label", "point text")

BEHIND = ("ground", "frame", "trough")
# Layers, with their colours in pictures and in DXF (of AutoCAD's index), and widths in points.
LAYERS = {"ground": ("saddlebrown", 34, 1.6), "frame": ("0.75", 9, 3), "trough": ("burlywood", 42, 3),
          "beam": ("black", 7, 3.5), "hanger": ("0.35", 8, 2), "counterweight": ("0.35", 8, 1),
          "sling": ("tab:purple", 6, 1.4), "projectile": ("tab:purple", 6, 1), "paths": ("tab:orange", 30, 1),
          "dimensions": ("tab:blue", 5, 0.8)}


def moved(shape, by):
    """A shape at another place."""
    points = {"points", "centre", "first", "last", "corner", "point"} & set(shape._fields)
    if isinstance(shape, Angle):
        points = {"corner"}
    return shape._replace(**{name: np.add(getattr(shape, name), by) for name in points})


def ends(dimension):
    """The ends of a dimension line, which is offset from the points that it measures."""
    first, last = map(np.asarray, (dimension.first, dimension.last))
    along = (last - first) / np.linalg.norm(last - first)
    away = dimension.offset * np.array([-along[1], along[0]])
    return first + away, last + away


def direction(angle):
    """The unit vector of an angle, rad from the x axis."""
    return np.array([np.cos(angle), np.sin(angle)])


def arc(angle, parts=40):
    """Points on the arc of an angle."""
    return [angle.corner + angle.radius * direction(a)
            for a in np.linspace(angle.first, angle.last, parts)]


def points_of(shape):
    """Points that enclose a shape, without its text."""
    if isinstance(shape, Line):
        return list(shape.points)
    if isinstance(shape, (Circle, Square)):
        half = shape.radius if isinstance(shape, Circle) else shape.side / 2
        return [np.add(shape.centre, (dx, dy)) for dx in (-half, half) for dy in (-half, half)]
    if isinstance(shape, Dimension):
        return [shape.first, shape.last, *ends(shape)]
    return arc(shape) if isinstance(shape, Angle) else [shape.point]


def bounds(shapes):
    """The lower left and the upper right corner of shapes."""
    points = np.array([point for shape in shapes for point in points_of(shape)])
    return points.min(axis=0), points.max(axis=0)


def draw(axes, shapes):
    """Draws shapes; the texts of dimensions are placed where they cover nothing."""
    anchors = []
    for shape in shapes:
        if isinstance(shape, Dimension):
            anchors.append((draw_dimension(axes, shape), shape.text))
        elif isinstance(shape, Angle):
            anchors.append((draw_angle(axes, shape), shape.text))
        elif isinstance(shape, Label):
            anchors.append((shape.point, shape.text))
        else:
            draw_body(axes, shape)
    place_texts(axes, anchors)


def draw_body(axes, shape):
    """Draws a path, a circle or a square."""
    colour, _, width = LAYERS[shape.layer]
    if isinstance(shape, Line):
        points = np.transpose(shape.points)
    else:
        corners = np.array(points_of(shape))[[0, 1, 3, 2, 0]]
        turned = np.linspace(0, 2 * np.pi, 60)
        points = (corners.T if isinstance(shape, Square) else
                  [shape.centre[0] + shape.radius * np.cos(turned),
                   shape.centre[1] + shape.radius * np.sin(turned)])
        axes.fill(*points, color=colour, alpha=0.35, linewidth=0)
    axes.plot(*points, color=colour, linewidth=width, solid_capstyle="butt",
              linestyle="--" if shape.layer == "paths" else "-", zorder=1.5 if shape.layer in BEHIND else 2)


def draw_dimension(axes, dimension):
    """Draws a dimension without its text; returns the middle of its line."""
    colour, _, width = LAYERS["dimensions"]
    first, last = ends(dimension)
    for point, end in ((dimension.first, first), (dimension.last, last)):
        axes.plot(*np.transpose([point, end]), color=colour, linewidth=width / 2)
    axes.plot(*np.transpose([first, last]), color=colour, linewidth=0)  # which texts avoid
    axes.annotate("", last, first, arrowprops={"arrowstyle": "<|-|>", "color": colour, "linewidth": width,
                                               "mutation_scale": 7, "shrinkA": 0, "shrinkB": 0})
    return (first + last) / 2


def draw_angle(axes, angle):
    """Draws an angle without its text; returns the middle of its arc."""
    colour, _, width = LAYERS["dimensions"]
    for side in (angle.first, angle.last):
        axes.plot(*np.transpose([angle.corner, angle.corner + 1.2 * angle.radius * direction(side)]),
                  color=colour, linewidth=width / 2, linestyle="-.")
    points = arc(angle)
    axes.plot(*np.transpose(points), color=colour, linewidth=width)
    return points[len(points) // 2]


def candidates(most=240, step=7):
    """Offsets from an anchor, in points, in the order in which a text tries them."""
    yield 0, 0
    for radius in range(10, most, step):
        for turned in np.radians(np.arange(0, 360, 20)):
            yield radius * np.cos(turned), 0.7 * radius * np.sin(turned)


def place_texts(axes, anchors):
    """Writes texts next to their anchors, where neither they nor the leader lines to them cover
    other texts, and they cover no line."""
    axes.figure.canvas.draw()
    colour = LAYERS["dimensions"][0]
    lines = [line.get_transform().transform_path(line.get_path()) for line in axes.lines]
    page, taken = axes.get_window_extent(), []

    def is_free(box, leader):
        return (page.x0 <= box.x0 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1 and
                not any(box.overlaps(other) or leader.intersects_bbox(other, filled=False) for other in taken) and
                not any(line.intersects_bbox(box, filled=False) for line in lines))

    for anchor, text in anchors:
        label = axes.text(*anchor, text, ha="center", va="center", color=colour, fontsize=7.5)
        start, to_data = axes.transData.transform(anchor), axes.transData.inverted()
        for offset in candidates():
            label.set_position(to_data.transform(start + np.array(offset) * axes.figure.dpi / 72))
            box = label.get_window_extent().padded(2)
            leader = Path([start, np.clip(start, box.min, box.max)])
            if is_free(box, leader):
                break
        taken.append(box)
        if not box.contains(*start):
            lines.append(leader)
            axes.plot(*to_data.transform(leader.vertices).T, color=colour, linewidth=0.4)


def write_dxf(path, shapes, factor, insert_units, texts):
    """
    Writes shapes, multiplied by a factor, as a DXF file with a layer for each kind. `texts` are
    written below them, one per line. Raises OSError.
    """
    import ezdxf

    low, high = bounds(shapes)
    height = factor * max(high - low) / 90  # of texts
    document = ezdxf.new("R2010", setup=True)
    document.units = insert_units
    space = document.modelspace()
    for name, (_, colour, _) in LAYERS.items():
        document.layers.add(name.upper(), color=colour)
    document.layers.add("TEXT", color=7)
    style = {"dimtxt": height, "dimasz": height, "dimexe": height / 2, "dimexo": height / 2,
             "dimgap": height / 2, "dimlfac": 1, "dimdec": 3, "dimtad": 1, "dimscale": 1}
    for shape in shapes:
        add_to_dxf(space, shape, factor, style)
    corner = factor * np.array([low[0], low[1]]) - (0, 6 * height)
    space.add_mtext("\n".join(texts), dxfattribs={"layer": "TEXT", "char_height": height,
                                                   "insert": tuple(corner), "attachment_point": 1})
    document.saveas(path)


def add_to_dxf(space, shape, factor, style):
    """Adds a shape to a DXF file's model space."""
    def at(point):
        return tuple(factor * float(x) for x in point)

    layer = {"layer": getattr(shape, "layer", "dimensions").upper()}
    if isinstance(shape, Line):
        space.add_lwpolyline([at(point) for point in shape.points], dxfattribs=layer)
    elif isinstance(shape, Circle):
        space.add_circle(at(shape.centre), factor * shape.radius, dxfattribs=layer)
    elif isinstance(shape, Square):
        corners = np.array(points_of(shape))[[0, 1, 3, 2]]
        space.add_lwpolyline([at(point) for point in corners], close=True, dxfattribs=layer)
    elif isinstance(shape, Dimension):
        space.add_aligned_dim(at(shape.first), at(shape.last), factor * shape.offset, text=shape.text,
                              override=style, dxfattribs=layer).render()
    elif isinstance(shape, Angle):
        half = factor * shape.radius / 2
        space.add_angular_dim_cra(at(shape.corner), half, np.degrees(shape.first), np.degrees(shape.last), half,
                                  text=shape.text, override=style, dxfattribs=layer).render()
    else:
        space.add_text(shape.text, height=style["dimtxt"], dxfattribs={"layer": "TEXT"}).set_placement(at(shape.point))
