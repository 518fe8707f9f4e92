"""Draws a sketch of the machine with the names of its lengths, masses, heights and angles.

One design is drawn to scale at three moments of its swing: at the start, on the way (in black, with
all labels) and at the release. It is one of the paper's or, with --built, one with a counterweight
on a hanger and a trough, as machines are built.

  treb-plot machine                                           -> machine.svg
  treb-plot machine --built                                   -> built.svg
"""

from collections import namedtuple

import numpy as np

from .picture import add_output, check_output, plt, save, size
from .program import Parser

# Lengths in m, r4 of the hanger, 0 without one; the height h0 of the fulcrum, which is the origin,
# above the ground, m; (phi1, phi2, phi3) in rad at three moments.
Machine = namedtuple("Machine", "r1 r2 r3 r4 height start middle release")
# From `trebsweep trace jobs/accurate.cfg --r1 0.7 --r2 0.9 --r3 0.5`.
PAPER = Machine(0.7, 0.9, 0.5, 0, 1.5, (0.7751933733, 0.0, 0.0), (2.198674944, 0.4972044215, 0.0),
                (np.pi, 2.416141533, 0.0))
# From a trace with these options.
BUILT_OPTIONS = ("--r1 0.6 --r2 1 --r3 1 --scene.counterweight-hanger 0.4 --scene.trough yes "
                 "--scene.start-angle 0.75 --scene.fulcrum-height 1 --scene.beam-density 700 "
                 "--scene.counterweight-mass 500 --scene.projectile-mass 20 "
                 "--solver.release farthest")
BUILT = Machine(0.6, 1.0, 1.0, 0.4, 1.0, (0.75, -1.29915687741, 0.0),
                (2.00483151862, 0.353390683675, 0.242129827758),
                (3.05651636579, 2.36436610966, -0.913195732526))
GREY = "0.62"


def positions(machine, angles):
    """Counterweight, hinge, tip of the throwing arm and projectile, (x, y) in m; the hinge of a
    fixed counterweight is at its place: (1), (2), (10), (11)."""
    arm, sling, hanger = (np.array([np.sin(angle), np.cos(angle)]) for angle in angles)
    hinge, tip = machine.r1 * arm, -machine.r2 * arm
    return hinge - machine.r4 * hanger, hinge, tip, tip - machine.r3 * sling


def draw_pose(axes, machine, angles, colour, **style):
    """Draws counterweight, beam, sling and projectile."""
    counterweight, hinge, tip, projectile = positions(machine, angles)
    axes.plot(*zip(hinge, tip), color=colour, linewidth=4, solid_capstyle="round", **style)
    axes.plot(*zip(tip, projectile), color=colour, linewidth=1.5, **style)
    if machine.r4:
        axes.plot(*zip(hinge, counterweight), color=colour, linewidth=2, **style)
        axes.plot(*hinge, "o", color="white", markeredgecolor=colour, markersize=6, **style)
    axes.plot(*counterweight, "s", color=colour, markersize=16, **style)
    axes.plot(*projectile, "o", color=colour, markersize=10, **style)


def draw_frame(axes, machine, label):
    """Draws ground, frame, with a label at (x, y), and fulcrum."""
    axes.axhline(-machine.height, color="saddlebrown", linewidth=2)
    axes.text(-1.3, -machine.height - 0.03, "ground", color="saddlebrown", va="top")
    for foot in (-0.28, 0.28):
        axes.plot([0, foot * machine.height], [0, -machine.height], color="burlywood", linewidth=5,
                  solid_capstyle="butt", zorder=0.5)
    axes.plot(0, 0, "o", color="white", markeredgecolor="black", markersize=9, zorder=4)
    axes.text(*label, "frame", color="peru")


def draw_height(axes, machine, x, top, reach, label):
    """Draws a height above the ground as an arrow at `x`, with a dotted line from `reach`."""
    axes.plot([reach, x + 0.05], [top, top], color="tab:blue", linewidth=0.8, linestyle=":")
    axes.annotate("", (x, top), (x, -machine.height),
                  arrowprops={"arrowstyle": "<->", "color": "tab:blue", "shrinkA": 0, "shrinkB": 0})
    axes.text(x + 0.03, (top - machine.height) / 2, label, color="tab:blue", va="center")


def draw_angle(axes, corner, radius, first, angle, label="", distance=0):
    """Draws an angle, rad, clockwise from the direction `first`, rad from the upward vertical."""
    def on_arc(fraction, length=radius):
        turned = first + fraction * angle
        return corner + length * np.array([np.sin(turned), np.cos(turned)])

    axes.plot(*zip(corner, on_arc(0, 1.35 * radius)), color="tab:red", linewidth=1, linestyle="--",
              zorder=3)
    axes.plot(*np.transpose([on_arc(f) for f in np.linspace(0, 0.97, 50)]), color="tab:red")
    axes.annotate("", on_arc(1), on_arc(0.94),
                  arrowprops={"arrowstyle": "-|>", "color": "tab:red", "shrinkA": 0, "shrinkB": 0})
    axes.text(*on_arc(0.5, distance), label, color="tab:red", ha="center", va="center", fontsize=11)


def draw_direction(axes, radius):
    """Draws the direction of the swing as an arrow around the fulcrum."""
    turned = np.linspace(np.radians(235), np.radians(290), 50)  # clockwise from the upward vertical
    path = radius * np.array([np.sin(turned), np.cos(turned)])
    axes.plot(*path, color="tab:green", linewidth=2)
    axes.annotate("", path[:, -1], path[:, -3],
                  arrowprops={"arrowstyle": "-|>", "color": "tab:green", "linewidth": 2})
    axes.text(*(0.82 * path[:, 25]), "swing", color="tab:green", ha="left", va="center")


def label_along(axes, corner, end, fraction, offset, text):
    """Labels a line with text that is turned into its direction."""
    slope = np.degrees(np.arctan2(*reversed(end - corner)))
    axes.text(*(corner + fraction * (end - corner) + offset), text, ha="center", va="bottom",
              rotation=(slope + 90) % 180 - 90, rotation_mode="anchor")


def label_paper(axes):
    """Labels arms, sling and masses of the paper's machine at the three moments."""
    counterweight, _, tip, projectile = positions(PAPER, PAPER.middle)
    label_along(axes, np.zeros(2), tip, 0.55, [0.03, 0.04], "throwing arm $r_2$")
    axes.text(*(counterweight / 2 + [0.08, 0.0]), "counterweight arm $r_1$", va="bottom")
    axes.text(*((tip + projectile) / 2 + [-0.05, 0.03]), "sling $r_3$", ha="right")
    axes.text(*(counterweight + [0, -0.09]), "counterweight $m_1$", ha="center", va="top")
    axes.text(*(projectile + [-0.06, -0.05]), "projectile $m_3$", ha="right", va="center")
    counterweight, _, _, projectile = positions(PAPER, PAPER.start)
    axes.text(*(counterweight + [-0.07, 0.1]), "counterweight at the start", color="0.4")
    axes.text(*(projectile + [-0.06, 0]), "projectile at the start", color="0.4", ha="right",
              va="center")
    axes.text(0.06, 1.0, r"release at $\phi_1 = \pi$", color="0.4")
    axes.text(1.1, 0.02, "fulcrum", color="tab:blue", ha="right")


def label_built(axes):
    """Labels arms, hanger, sling, masses, trough and pin's angle of the built machine."""
    counterweight, hinge, tip, projectile = positions(BUILT, BUILT.middle)
    label_along(axes, np.zeros(2), tip, 0.5, [0.02, 0.04], "throwing arm $r_2$")
    axes.text(*(hinge / 2 + [0.06, 0.03]), "counterweight arm $r_1$", va="bottom")
    axes.text(*(hinge + [0.05, -0.17]), "hanger $r_4$", va="center")
    axes.text(*(hinge + [-0.12, -0.22]), r"$\phi_3$", color="tab:red", ha="center", va="center",
              fontsize=11)
    axes.text(*((tip + projectile) / 2 + [-0.05, 0.03]), "sling $r_3$", ha="right")
    axes.text(*(counterweight + [0.1, 0]), "counterweight $m_1$", va="center")
    axes.text(*(projectile + [-0.02, -0.07]), "projectile $m_3$", ha="center", va="top")
    _, hinge, _, projectile = positions(BUILT, BUILT.start)
    axes.text(*(hinge + [0.06, -0.15]), "counterweight at the start", color="0.4", va="center")
    axes.plot([projectile[0] + 0.06, -0.75], [-BUILT.height] * 2, color="burlywood", linewidth=7,
              solid_capstyle="butt", zorder=0.7)
    axes.text(projectile[0] + 0.1, -BUILT.height - 0.05, "projectile at the start, in the trough",
              color="0.4", va="top")
    _, _, tip, projectile = positions(BUILT, BUILT.release)
    axes.text(*(projectile + [0.09, 0.02]), "release", color="0.4", va="center")
    axes.text(*(tip + [0.02, 0.45]), r"pin angle $\phi_1 - \phi_2$", color="tab:red", fontsize=11)
    axes.text(1.1, 0.02, "fulcrum", color="tab:blue", ha="right")


def draw_paper(axes):
    """Draws heights, angles and labels of the paper's machine."""
    start, middle = (positions(PAPER, angles) for angles in (PAPER.start, PAPER.middle))
    draw_frame(axes, PAPER, (0.37, -1.15))
    draw_height(axes, PAPER, 1.15, 0.0, 0.06, "$h_0$")
    draw_height(axes, PAPER, 1.35, start[0][1], start[0][0] + 0.08, "$h$")
    draw_angle(axes, np.zeros(2), 0.26, 0, PAPER.middle[0], r"$\phi_1$", 0.36)
    draw_angle(axes, middle[2], 0.24, np.pi, PAPER.middle[1], r"$\phi_2$", 0.33)
    draw_direction(axes, 0.5)
    label_paper(axes)
    axes.set(xlim=(-1.4, 1.5), ylim=(-1.65, 1.35))


def draw_built(axes):
    """Draws heights, angles and labels of the built machine."""
    middle, release = (positions(BUILT, angles) for angles in (BUILT.middle, BUILT.release))
    draw_frame(axes, BUILT, (-0.42, -0.66))
    draw_height(axes, BUILT, 1.15, 0.0, 0.06, "$h_0$")
    draw_angle(axes, np.zeros(2), 0.2, 0, BUILT.middle[0], r"$\phi_1$", 0.29)
    draw_angle(axes, middle[2], 0.5, np.pi, BUILT.middle[1], r"$\phi_2$", 0.6)
    draw_angle(axes, middle[1], 0.26, np.pi, BUILT.middle[2])
    continued = BUILT.release[0] - np.pi
    draw_angle(axes, release[2], 0.42, continued, BUILT.release[1] - BUILT.release[0])
    draw_direction(axes, 0.5)
    label_built(axes)
    axes.set(xlim=(-1.5, 1.4), ylim=(-1.15, 1.85))


def draw(built=False):
    """The figure."""
    machine = BUILT if built else PAPER
    with plt.rc_context({"font.size": 9}):
        figure, axes = plt.subplots(figsize=size(1))
        for angles in (machine.start, machine.release):
            draw_pose(axes, machine, angles, GREY, zorder=1.5)
        draw_pose(axes, machine, machine.middle, "black", zorder=2)
        (draw_built if built else draw_paper)(axes)
        axes.set(aspect="equal")
        axes.set_axis_off()
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("--built", action="store_true",
                        help="draw a machine with a hanger and a trough")
    add_output(parser, "machine.svg, or built.svg")
    arguments = parser.parse_args()

    output = arguments.output or ("built.svg" if arguments.built else "machine.svg")
    check_output(output)
    save(draw(arguments.built), output)
