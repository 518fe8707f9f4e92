"""The machine of an optimum as shapes of a drawing: at the start and at the release, with dimensions.

Coordinates are in m from the axle, as in the tables of `trebsweep trace`.
"""

import numpy as np

from . import drawing
from .drawing import Angle, Circle, Dimension, Label, Line, Square
from .job import parse_job
from .swing import lift_off

FRAME_FEET = (-0.3, 0.3)  # of the frame, which is a sketch, in heights of the axle


class Machine:
    """A design with its scene and its swing."""

    def __init__(self, optimum, swing):
        self.optimum, self.swing = optimum, swing
        self.scene = {key: value for (section, key), value in parse_job(optimum["job"]).items()
                      if section == "scene"}
        self.r1, self.r2, self.r3 = (optimum[name] for name in ("r1", "r2", "r3"))
        self.r4, self.h0 = self.number("counterweight-hanger"), self.number("fulcrum-height")
        self.has_trough = self.scene.get("trough") == "yes"
        self.deviation = float(parse_job(optimum["job"])["optimum", "deviation"])

    def number(self, key, default=0.0):
        """A number of the scene."""
        return float(self.scene.get(key, default))

    def value(self, field):
        """A field at the optimum, or None."""
        return self.optimum["values"].get(field)

    def points(self, row):
        """Hinge, counterweight, arm's tip and projectile in a row of the swing, m."""
        rows = self.swing
        hinge = "h" if "xh" in rows else "1"
        return [np.array([rows[f"x{body}"].iloc[row], rows[f"y{body}"].iloc[row]])
                for body in (hinge, "1", "t", "3")]

    def trough(self):
        """Where the projectile starts in the trough, and leaves it, m from below the axle."""
        at_start, lifted = self.points(0)[3], lift_off(self.swing)
        return at_start[0], lifted[1] if lifted else at_start[0] - self.r3

    def path(self, body):
        """The path of a body, m."""
        return np.column_stack([self.swing[f"x{body}"], self.swing[f"y{body}"]])

    def beam(self):
        """The beam's mass, kg, and the (width, depth) of its section, m, or None for a measured beam."""
        if "beam-mass" in self.scene:
            return self.number("beam-mass"), None
        section = [self.number(key) if key in self.scene else self.number("beam-side")
                   for key in ("beam-width", "beam-depth")]
        return self.number("beam-density") * section[0] * section[1] * (self.r1 + self.r2), section


def poses(machine, row, unit):
    """Beam, hanger, sling, masses and fulcrum in a row of the swing."""
    hinge, counterweight, tip, projectile = machine.points(row)
    shapes = [Line("beam", [hinge, tip]), Line("sling", [tip, projectile]),
              Square("counterweight", counterweight, 5 * unit),
              Circle("projectile", projectile, max(machine.number("projectile-diameter") / 2, 1.2 * unit)),
              Circle("frame", np.zeros(2), unit)]
    if machine.r4:
        shapes.append(Line("hanger", [hinge, counterweight]))
    return shapes


def surroundings(machine, low, high):
    """The ground from x = low to high, the frame and the trough."""
    ground = -machine.h0
    shapes = [Line("ground", [(low, ground), (high, ground)])]
    for foot in FRAME_FEET:
        shapes.append(Line("frame", [(0, 0), (foot * machine.h0, ground)]))
    if machine.has_trough:
        height = ground + machine.number("trough-height")
        shapes.append(Line("trough", [(x, height) for x in machine.trough()]))
    return shapes


def start_dimensions(machine, unit, units):
    """The dimensions of the machine at the start."""
    hinge, counterweight, tip, projectile = machine.points(0)
    axle, foot = np.zeros(2), np.array([0, -machine.h0])
    offset = 6 * unit
    stretched = ", here stretched" if machine.number("sling-stiffness") else ""
    shapes = [Dimension(axle, hinge, offset, f"r1 {units.length(machine.r1)}"),
              Dimension(tip, axle, offset, f"r2 {units.length(machine.r2)}"),
              Dimension(tip, projectile, -offset, f"r3 {units.length(machine.r3)}{stretched}"),
              Dimension(foot, axle, 0, f"axle {units.length(machine.h0)}")]
    if machine.r4:
        shapes.append(Dimension(counterweight, hinge, -offset, f"r4 {units.length(machine.r4)}"))
    above = tip[1] + machine.h0
    if above > 2 * unit:
        shapes.append(Dimension((tip[0], -machine.h0), tip, 2 * offset, f"tip {units.length(above)}"))
    phi1 = machine.swing["phi1"][0]
    shapes.append(Angle(axle, *sorted((np.pi / 2 - phi1, np.pi / 2)), min(machine.r1, machine.r2) * 0.6,
                        units.degrees(phi1)))
    return shapes


def release_dimensions(machine, units):
    """The angle of the pin: from the arm's continuation to the sling."""
    _, _, tip, projectile = machine.points(-1)
    arm = np.arctan2(tip[1], tip[0])
    pin = machine.value("pin-angle")  # counterclockwise: phi1 and phi2 are clockwise
    return [Angle(tip, *sorted((arm, arm + pin)), 0.45 * min(machine.r3, machine.r2),
                  f"pin {units.degrees(pin)}")]


def panels(machine, units):
    """The shapes of the machine at the start and of that at the release, which has the paths."""
    everything = np.vstack([machine.path("1"), machine.path("3"), machine.path("t"), [(0, -machine.h0)]])
    unit = np.ptp(everything, axis=0).max() / 80
    start = poses(machine, 0, unit) + start_dimensions(machine, unit, units)
    release = poses(machine, -1, unit) + release_dimensions(machine, units)
    release += [Line("paths", machine.path("3")), Line("paths", machine.path("1"))]
    for shapes, title in ((start, "start"), (release, "release")):
        feet = Line("frame", [(foot * machine.h0, -machine.h0) for foot in FRAME_FEET])
        (left, _), (right, _) = drawing.bounds([*shapes, feet])
        shapes += surroundings(machine, left - 2 * unit, right + 2 * unit)
        shapes.append(Label((right, -machine.h0 - 2 * unit), title))
    return start, release


def arranged(start, release, aspect):
    """Both panels in one drawing, side by side or stacked, whichever fills a page better that is
    `aspect` times as wide as high."""
    (low, high), (other_low, other_high) = drawing.bounds(start), drawing.bounds(release)
    size, other = high - low, other_high - other_low
    gap = 0.06 * max(size.max(), other.max())
    side_by_side = max((size[0] + other[0] + gap) / aspect, high[1] - low[1], other[1])
    stacked = max(size[0] / aspect, other[0] / aspect, size[1] + other[1] + gap)
    if side_by_side <= stacked:  # heights of the page
        by = (high[0] - other_low[0] + gap, 0)
    else:
        by = (low[0] - other_low[0], low[1] - other_high[1] - gap)
    return start + [drawing.moved(shape, by) for shape in release]
