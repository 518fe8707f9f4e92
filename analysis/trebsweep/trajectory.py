"""Draws a swing, and its flight, from the tables that `trebsweep trace` prints.

Upper left: the angles against time (the paper's Figure 2), or with --phase the angular velocities
against the angles. Upper right: beam, sling, projectile
and, if it has one, the counterweight's hanger at equal intervals of time, with the projectile's
path, the trough and the ground. Below, with --flight: the projectile's path to the ground.

Ground, trough and lift-off need the comments above the table's header (`# fulcrum-height = 1.5`,
`# lift-off-time = 0.25`, ...); without them they are not drawn.

  trebsweep trace jobs/accurate.cfg --r1 0.51 --r2 0.91 --r3 0.58 > swing.txt
  trebsweep trace jobs/accurate.cfg --r1 0.51 --r2 0.91 --r3 0.58 --flight > flight.txt
  treb-plot trajectory swing.txt --flight flight.txt          -> swing.png
"""

import os

import numpy as np

from .picture import add_output, check_output, plt, save, set_title, size, wrapped
from .program import Parser, refuse
from .swing import lift_off, read_flight, read_swing, setting


def draw_angles(axes, table):
    """Draws the angles against time, and the time of the lift-off."""
    axes.plot(table["t"], table["phi1"], label=r"$\phi_1$, counterweight arm")
    axes.plot(table["t"], table["phi2"], "--", label=r"$\phi_2$, sling")
    if "phi3" in table:
        axes.plot(table["t"], table["phi3"], "-.", label=r"$\phi_3$, hanger")
    axes.axhline(np.pi, color="grey", linewidth=0.8)
    axes.annotate(r"$\pi$", (table["t"].iloc[0], np.pi), xytext=(2, 3), textcoords="offset points",
                  color="grey")
    if lift_off(table):
        axes.axvline(lift_off(table)[0], color="grey", linewidth=0.8, linestyle=":",
                     label="lift-off")
    axes.set_xlabel("time t (s)")
    axes.set_ylabel("angle (rad)")
    axes.margins(y=0.08)
    axes.set_title("Angles, clockwise from the vertical")


def draw_phase(axes, table):
    """Draws the angular velocities against the angles."""
    for angle, rate, style, text in (("phi1", "w1", "-", "counterweight arm"), ("phi2", "w2", "--", "sling"),
                                     ("phi3", "w3", "-.", "hanger")):
        if angle in table:
            line, = axes.plot(table[angle], table[rate], style, label=rf"$\phi_{angle[-1]}$, {text}")
            axes.plot(table[angle].iloc[0], table[rate].iloc[0], "o", color=line.get_color(), markersize=4)
    axes.set_xlabel("angle (rad)")
    axes.set_ylabel("angular velocity (rad/s)")
    axes.set_title("Phase portrait, from the dots")


def draw_surroundings(axes, table):
    """Draws the fulcrum, the ground, if its height is known, and the labels of the axes."""
    axes.plot(0, 0, "k^", markersize=7, label="fulcrum")
    height = setting(table, "fulcrum-height")
    if height is not None:
        axes.axhline(-height, color="saddlebrown", linewidth=1.5, label="ground")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y, upward from the fulcrum (m)")


def draw_trough(axes, table):
    """Draws the trough, in which the projectile slides up to the lift-off, or to the end."""
    if setting(table, "trough-height") is None:
        return
    x, y = table["x3"].to_numpy(), table["y3"].to_numpy()
    end = lift_off(table)
    slid = x if end is None else [*x[table["t"] < end[0]], end[1]]
    axes.plot([min(slid), max(slid)], [y[0], y[0]], color="burlywood", linewidth=9,
              solid_capstyle="butt", label="trough", zorder=1.5)
    if end is not None:
        axes.plot(*end[1:], "D", color="white", markeredgecolor="red", markersize=6,
                  label="lift-off", zorder=3)


def draw_machine(axes, rows, i, colour):
    """Draws beam, hanger, sling, counterweight and projectile of a row."""
    hinge = ("xh", "yh") if "xh" in rows else ("x1", "y1")
    for first, second, width in ((hinge, ("xt", "yt"), 2), (hinge, ("x1", "y1"), 1.2),
                                 (("xt", "yt"), ("x3", "y3"), 0.8)):
        axes.plot(*([rows[name][i] for name in names] for names in zip(first, second)),
                  color=colour, linewidth=width)
    axes.plot(rows["x1"][i], rows["y1"][i], "s", color=colour, markersize=7)
    axes.plot(rows["x3"][i], rows["y3"][i], "o", color=colour, markersize=4)


def draw_strobe(axes, table, count, flight):
    """Draws the machine at `count` equally spaced times, and the path."""
    start, end = table["t"].iloc[0], table["t"].iloc[-1]
    length = end - start or 1
    chosen = sorted({int(np.argmin(np.abs(table["t"] - time))) for time in np.linspace(start, end, count)})
    colours = plt.matplotlib.colors.ListedColormap(plt.get_cmap("viridis")(np.linspace(0, 0.8, 256)))  # dark on white
    for i in chosen:
        draw_machine(axes, table, i, colours((table["t"][i] - start) / length))
    draw_surroundings(axes, table)
    draw_trough(axes, table)
    axes.plot(table["x3"], table["y3"], color="red", linewidth=0.8, label="projectile")
    if flight is not None:
        limits = axes.axis()
        axes.plot(flight["x3"], flight["y3"], ":", color="red", linewidth=1.2, label="flight")
        axes.axis(limits)  # without the flight, which is much longer
    moment = "release" if setting(table, "release-time") is not None else "end"
    axes.set_title(f"t = {start:g} to {end:.4g} s, {table['speed'].iloc[-1]:.5g} m/s at the {moment}")
    axes.set_aspect("equal", adjustable="datalim")
    scale = plt.cm.ScalarMappable(plt.Normalize(start, start + length), colours)
    axes.figure.colorbar(scale, ax=axes, label="time (s)")


def draw_flight(axes, table, flight):
    """Draws the projectile's path to the ground."""
    draw_surroundings(axes, table)
    axes.plot(table["x3"], table["y3"], color="red", linewidth=0.8, label="projectile")
    t, x, y, speed = (flight[name].to_numpy() for name in ("t", "x3", "y3", "speed"))
    axes.plot(x, y, ":", color="red", linewidth=1.2, label="flight")
    axes.plot(x[-1], y[-1], "x", color="red", label="impact")
    axes.set_title(wrapped(f"Flight: range {x[-1]:.4g} m from the foot of the fulcrum, up to "
                           f"{y.max() - y[-1]:.4g} m above the ground; impact after {t[-1] - t[0]:.3g} s "
                           f"at {speed[-1]:.4g} m/s", axes.figure.get_figwidth()))
    axes.set_aspect("equal", adjustable="datalim")


def lengths_text(table):
    """The lengths of the machine at the start of a swing."""
    row = table.iloc[0]
    hinge = "h" if "xh" in table else "1"
    r1, r2 = np.hypot(row[f"x{hinge}"], row[f"y{hinge}"]), np.hypot(row["xt"], row["yt"])
    r3 = np.hypot(row["x3"] - row["xt"], row["y3"] - row["yt"])
    hanger = f", hanger {np.hypot(row['x1'] - row['xh'], row['y1'] - row['yh']):.4g}" if "xh" in table else ""
    return f"r1 = {r1:.4g}, r2 = {r2:.4g}, r3 = {r3:.4g}{hanger} m"


def draw(table, name, count, flight=None, phase=False):
    """The figure of a swing, and of its flight if it has one; with the phase portrait or the angles against time."""
    figure = plt.figure(figsize=size(0.5 if flight is None else 0.85))
    rows = [["angles", "strobe"], *([["flight", "flight"]] if flight is not None else []), ["legend", "legend"]]
    heights = [3, *([2] if flight is not None else []), 0.6]
    panels = figure.subplot_mosaic(rows, gridspec_kw={"height_ratios": heights, "width_ratios": (1, 1.4)})
    (draw_phase if phase else draw_angles)(panels["angles"], table)
    draw_strobe(panels["strobe"], table, count, flight)
    if flight is not None:
        draw_flight(panels["flight"], table, flight)
    shown = {text: line for panel in ("angles", "strobe", "flight") if panel in panels
             for line, text in zip(*panels[panel].get_legend_handles_labels())}
    panels["legend"].set_axis_off()
    panels["legend"].legend(shown.values(), shown.keys(), loc="center", ncol=4)
    set_title(figure, f"{name}: {lengths_text(table)}")
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("table", metavar="TABLE", help="output of 'trebsweep trace'")
    parser.add_argument("--count", type=int, default=16,
                        help="number of positions to draw, at least 2 (default: 16)")
    parser.add_argument("--flight", metavar="TABLE",
                        help="output of 'trebsweep trace --flight' for the same swing")
    parser.add_argument("--phase", action="store_true",
                        help="draw angular velocities against angles instead of angles against time")
    add_output(parser, "the table's name with .png")
    arguments = parser.parse_args()

    if arguments.count < 2:
        refuse("count", arguments.count, "must be at least 2")
    output = arguments.output or os.path.splitext(arguments.table)[0] + ".png"
    tables = [name for name in (arguments.table, arguments.flight) if name]
    check_output(output, *tables)
    table = read_swing(arguments.table)
    flight = read_flight(arguments.flight, table) if arguments.flight else None
    name = os.path.splitext(os.path.basename(arguments.table))[0]
    save(draw(table, name, arguments.count, flight, arguments.phase), output)
