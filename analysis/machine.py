#!/usr/bin/env python3
"""Draws a sketch of the machine with the names of its lengths, masses, heights and angles.

One design is drawn to scale, in the paper's scene, at three moments of its swing: at the start, on
the way (in black, with all labels) and at the release.

  machine.py                                           -> machine.svg
"""

from program import Parser, run  # before modules that may be missing

import numpy as np

from picture import OUTPUT_HELP, check_output, plt, save

HEIGHT = 1.5  # h0 of the fulcrum, which is the origin, above the ground, m
DESIGN = (0.7, 0.9, 0.5)  # r1, r2, r3, m
# (phi1, phi2) in rad, from `trebsweep trace jobs/accurate.cfg --r1 0.7 --r2 0.9 --r3 0.5`
START, MIDDLE, RELEASE = (0.7751933733, 0.0), (2.198674944, 0.4972044215), (np.pi, 2.416141533)
GREY = "0.62"


def positions(angles):
    """Counterweight, tip of the throwing arm and projectile, (x, y) in m: (1), (2), (10), (11)."""
    r1, r2, r3 = DESIGN
    arm, sling = (np.array([np.sin(angle), np.cos(angle)]) for angle in angles)
    return r1 * arm, -r2 * arm, -r2 * arm - r3 * sling


def draw_pose(axes, angles, colour, **style):
    """Draws counterweight, beam, sling and projectile."""
    counterweight, tip, projectile = positions(angles)
    axes.plot(*zip(counterweight, tip), color=colour, linewidth=4, solid_capstyle="round", **style)
    axes.plot(*zip(tip, projectile), color=colour, linewidth=1.5, **style)
    axes.plot(*counterweight, "s", color=colour, markersize=22, **style)
    axes.plot(*projectile, "o", color=colour, markersize=10, **style)


def draw_frame(axes):
    """Draws ground, frame and fulcrum."""
    axes.axhline(-HEIGHT, color="saddlebrown", linewidth=2)
    axes.text(-1.3, -HEIGHT - 0.03, "ground", color="saddlebrown", va="top")
    for foot in (-0.42, 0.42):
        axes.plot([0, foot], [0, -HEIGHT], color="burlywood", linewidth=5,
                  solid_capstyle="butt", zorder=0.5)
    axes.plot(0, 0, "o", color="white", markeredgecolor="black", markersize=9, zorder=4)
    axes.text(1.1, 0.02, "fulcrum", color="tab:blue", ha="right")
    axes.text(0.37, -1.15, "frame", color="peru")


def draw_height(axes, x, top, reach, label):
    """Draws a height above the ground as an arrow at `x`, with a dotted line from `reach`."""
    axes.plot([reach, x + 0.05], [top, top], color="tab:blue", linewidth=0.8, linestyle=":")
    axes.annotate("", (x, top), (x, -HEIGHT),
                  arrowprops={"arrowstyle": "<->", "color": "tab:blue", "shrinkA": 0, "shrinkB": 0})
    axes.text(x + 0.03, (top - HEIGHT) / 2, label, color="tab:blue", va="center")


def draw_angle(axes, corner, radius, first, angle, label, distance):
    """Draws an angle, rad, clockwise from the direction `first`, rad from the upward vertical."""
    def on_arc(fraction, length=radius):
        turned = first + fraction * angle
        return corner + length * np.array([np.sin(turned), np.cos(turned)])

    axes.plot(*zip(corner, on_arc(0, 1.35 * radius)), color="tab:red", linewidth=1, linestyle="--",
              zorder=3)
    axes.plot(*np.transpose([on_arc(f) for f in np.linspace(0, 0.97, 50)]), color="tab:red")
    axes.annotate("", on_arc(1), on_arc(0.94),
                  arrowprops={"arrowstyle": "-|>", "color": "tab:red", "shrinkA": 0, "shrinkB": 0})
    axes.text(*on_arc(0.5, distance), label, color="tab:red", ha="center", va="center", fontsize=15)


def draw_direction(axes, radius):
    """Draws the direction of the swing as an arrow around the fulcrum."""
    turned = np.linspace(np.radians(235), np.radians(290), 50)  # clockwise from the upward vertical
    path = radius * np.array([np.sin(turned), np.cos(turned)])
    axes.plot(*path, color="tab:green", linewidth=2)
    axes.annotate("", path[:, -1], path[:, -3],
                  arrowprops={"arrowstyle": "-|>", "color": "tab:green", "linewidth": 2})
    axes.text(*(0.82 * path[:, 25]), "swing", color="tab:green", ha="left", va="center")


def label_bodies(axes):
    """Labels arms, sling and masses at the three moments."""
    counterweight, tip, projectile = positions(MIDDLE)
    slope = np.degrees(np.arctan2(tip[1], tip[0])) - 180
    axes.text(*(0.55 * tip + [0.03, 0.04]), "throwing arm $r_2$", ha="center", va="bottom",
              rotation=slope, rotation_mode="anchor")
    axes.text(*(counterweight / 2 + [0.08, 0.0]), "counterweight arm $r_1$", va="bottom")
    axes.text(*((tip + projectile) / 2 + [-0.05, 0.03]), "sling $r_3$", ha="right")
    axes.text(*(counterweight + [0, -0.09]), "counterweight $m_1$", ha="center", va="top")
    axes.text(*(projectile + [-0.06, -0.05]), "projectile $m_3$", ha="right", va="center")
    counterweight, _, projectile = positions(START)
    axes.text(*(counterweight + [-0.07, 0.1]), "counterweight at the start", color="0.4")
    axes.text(*(projectile + [-0.06, 0]), "projectile at the start", color="0.4", ha="right",
              va="center")
    axes.text(0.06, 1.0, r"release at $\phi_1 = \pi$", color="0.4")


def draw():
    """The figure."""
    with plt.rc_context({"font.size": 12}):
        figure, axes = plt.subplots(figsize=(8.2, 8.2))
        draw_frame(axes)
        for angles in (START, RELEASE):
            draw_pose(axes, angles, GREY, zorder=1.5)
        draw_pose(axes, MIDDLE, "black", zorder=2)
        start = positions(START)[0]
        draw_height(axes, 1.15, 0.0, 0.06, "$h_0$")
        draw_height(axes, 1.35, start[1], start[0] + 0.08, "$h$")
        draw_angle(axes, np.zeros(2), 0.26, 0, MIDDLE[0], r"$\phi_1$", 0.36)
        draw_angle(axes, positions(MIDDLE)[1], 0.24, np.pi, MIDDLE[1], r"$\phi_2$", 0.33)
        draw_direction(axes, 0.5)
        label_bodies(axes)
        axes.set(xlim=(-1.4, 1.5), ylim=(-1.65, 1.35), aspect="equal")
        axes.set_axis_off()
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("-o", "--output", metavar="PICTURE", default="machine.svg",
                        help=OUTPUT_HELP + "default: machine.svg")
    arguments = parser.parse_args()

    check_output(arguments.output)
    save(draw(), arguments.output)


if __name__ == "__main__":
    run(main)
