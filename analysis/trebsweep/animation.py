"""Animates a swing, from the table that `trebsweep trace` prints.

The name ends in .gif, or in .html for a page that plays the pictures and can stop at each.

  trebsweep trace jobs/accurate.cfg --r1 0.51 --r2 0.91 --r3 0.58 > swing.txt
  treb-plot animation swing.txt                        -> swing.gif
"""

import os

import numpy as np

from .picture import plt, set_title, size, with_width
from .program import Parser, check_new, fail, refuse
from .swing import read_swing
from .trajectory import draw_machine, draw_surroundings, draw_trough, lengths_text


def animate(table, name, frames, slower):
    """The animation of a swing, in as many pictures, and the time between two of them, ms."""
    from matplotlib.animation import FuncAnimation

    times = np.linspace(table["t"].iloc[0], table["t"].iloc[-1], frames)
    chosen = [int(np.argmin(np.abs(table["t"] - time))) for time in times]
    figure, axes = plt.subplots(figsize=size(0.7, 0.7))
    bodies = [np.concatenate([table[f"{axis}{body}"] for body in ("1", "t", "3")]) for axis in "xy"]
    margin = 0.05 * max(map(np.ptp, bodies))
    draw_surroundings(axes, table)
    draw_trough(axes, table)
    fixed = len(axes.lines)
    axes.set_aspect("equal")
    axes.xaxis.set_major_locator(plt.MaxNLocator(5))
    axes.set(xlim=(bodies[0].min() - margin, bodies[0].max() + margin),
             ylim=(bodies[1].min() - margin, bodies[1].max() + margin))
    set_title(figure, f"{name}: {lengths_text(table)}")

    def show(i):
        for line in axes.lines[fixed:]:
            line.remove()
        axes.plot(table["x3"][:i + 1], table["y3"][:i + 1], color="red", linewidth=0.8)
        draw_machine(axes, table, i, "black")
        axes.set_title(f"t = {table['t'][i]:.3f} s, {table['speed'][i]:.4g} m/s")

    interval = 1000 * slower * (times[-1] - times[0]) / max(frames - 1, 1)
    return figure, FuncAnimation(figure, show, chosen, init_func=lambda: None, interval=interval), interval


def main():
    parser = Parser(__doc__)
    parser.add_argument("table", metavar="TABLE", help="output of 'trebsweep trace'")
    parser.add_argument("--count", type=int, default=60, help="number of pictures, 2 to 1000 (default: 60)")
    parser.add_argument("--slower", type=float, default=4, help="how much slower than the swing (default: 4)")
    parser.add_argument("-o", "--output", metavar="FILE", 
                        help="ends in .gif or .html; default: the table's name with .gif")
    with_width(parser)
    parser.add_overwrite()
    arguments = parser.parse_args()

    output = arguments.output or os.path.splitext(arguments.table)[0] + ".gif"
    if not output.endswith((".gif", ".html")):
        refuse("output", output, "must end in .gif or .html")
    if not 2 <= arguments.count <= 1000:
        refuse("count", arguments.count, "must be from 2 to 1000")
    if not 0.01 <= arguments.slower <= 1000:
        refuse("slower", f"{arguments.slower:g}", "must be from 0.01 to 1000")
    check_new("output", output, arguments.overwrite, arguments.table)
    name = os.path.splitext(os.path.basename(arguments.table))[0]
    figure, animation, interval = animate(read_swing(arguments.table), name, arguments.count, arguments.slower)
    try:
        if output.endswith(".gif"):
            animation.save(output, writer="pillow", fps=1000 / interval, dpi=100)
        else:
            with open(output, "w", encoding="utf-8") as file:
                file.write(animation.to_jshtml())
    except OSError as error:
        fail(f"{output}: cannot be written: {error.strerror}")
    plt.close(figure)
    print(output)
