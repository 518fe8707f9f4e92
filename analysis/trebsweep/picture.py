"""Files, sizes, titles and units of the pictures."""

import argparse
import functools
import logging
import os
import textwrap
import warnings

import numpy as np

from . import program
from .program import fail, refuse


@functools.cache
def import_pyplot():
    """matplotlib.pyplot, set up to write files."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # PostScript lacks transparency
    pyplot.rcParams["svg.hashsalt"] = "trebsweep"  # the same picture has the same bytes
    pyplot.rcParams.update({
        "figure.constrained_layout.use": True, "figure.constrained_layout.w_pad": 0.06,
        "figure.constrained_layout.h_pad": 0.06, "axes.formatter.useoffset": False,  # the offset would overlap titles
        "font.size": POINTS, "legend.fontsize": POINTS, "axes.titlesize": POINTS, "axes.labelsize": POINTS,
        "xtick.labelsize": POINTS, "ytick.labelsize": POINTS, "figure.titlesize": POINTS + 1, "axes.linewidth": 0.6,
        "lines.linewidth": 1.2, "legend.frameon": False, "legend.handlelength": 1.6})
    return pyplot


class Pyplot:
    """matplotlib.pyplot, imported at its first use: errors in the input are reported at once."""

    def __getattr__(self, name):
        return getattr(import_pyplot(), name)


plt = Pyplot()

FORMATS = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF", "eps": b"%!PS", "ps": b"%!PS",
           "jpg": b"\xff\xd8", "tif": b"II*", "webp": b"RIFF"}  # with what their files begin
PREFIXED = ("N", "Pa", "J")  # units that take a prefix
POINTS = 8  # of text in a picture, at least
WIDTH = 17  # cm: of a picture without --width
# Colours that the colour-blind can tell apart (Okabe and Ito), and in grey; markers for lines that share a panel.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "black")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
OUTPUT_HELP = (f"the suffix selects the format ({', '.join(FORMATS)}); without a suffix a PNG is "
               f"written under exactly this name; ")


def add_output(parser, default):
    """Adds the options of a picture's file and size; `default` tells the file's name without -o."""
    parser.add_argument("-o", "--output", metavar="PICTURE", help=f"{OUTPUT_HELP}default: {default}")
    with_width(parser)


def with_width(parser):
    """Adds the option of a picture's width."""
    parser.add_argument("--width", type=float, default=WIDTH, action=SetWidth, metavar="CM",
                        help=f"width of the picture, 8 to 100 cm (default: {WIDTH}); text has {POINTS} points or more")


class SetWidth(argparse.Action):
    """The option --width: of the pictures that follow."""

    def __call__(self, parser, namespace, values, option_string=None):
        if not 8 <= values <= 100:
            refuse("width", f"{values:g}", "must be from 8 to 100 cm")
        width[0] = values


width = [WIDTH]  # cm, of the pictures


def size(ratio, part=1.0):
    """Width and height in inches of a picture that takes a part of the width; height = ratio * whole width."""
    inches = width[0] / 2.54
    return part * inches, ratio * inches


def with_legend(ratio, lines, rows=1, columns=1, **options):
    """A figure, an array of its panels, and axes below them for a legend of some lines."""
    figure = plt.figure(figsize=size(ratio))
    legend = lines * 1.6 * POINTS / 72
    heights = [(figure.get_figheight() - legend) / rows] * rows + [legend]
    places = figure.add_gridspec(rows + 1, columns, height_ratios=heights)
    panels = np.empty((rows, columns), object)
    for row, column in np.ndindex(rows, columns):
        shared = {axis: panels[0, 0] for axis in options} if row + column else {}
        panels[row, column] = figure.add_subplot(places[row, column], **shared)
    below = figure.add_subplot(places[rows, :])
    below.set_axis_off()
    return figure, panels, below


def picture_format(path):
    """The format that belongs to the suffix of a picture's name."""
    return os.path.splitext(path)[1][1:].lower() or "png"


def is_picture(path):
    """Whether a file is empty, or a picture of the format that belongs to its name."""
    with open(path, "rb") as file:
        start = file.read(8)
    return not start or start.startswith(FORMATS[picture_format(path)])


def check_output(path, *inputs):
    """Refuses a name that has no format of pictures, or is that of an input file or of any other
    file than a picture."""
    if picture_format(path) not in FORMATS:
        refuse("output", path,
               f"must end in one of .{', .'.join(FORMATS)}, or have no suffix (PNG)")
    program.check_output("output", path, inputs, not os.path.isfile(path) or is_picture(path),
                         f"exists and is no {picture_format(path).upper()}; name another file")


def save(figure, path):
    """Writes a picture, and prints its name."""
    try:
        with open(path, "wb") as file, warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Glyph .* missing from ")  # in an archive's name
            form = picture_format(path)
            undated = {"metadata": {"Date": None}} if form == "svg" else {}
            figure.savefig(file, format=form, dpi=200, **undated)
    except OSError as error:
        fail(f"{path}: cannot be written: {error.strerror or error}")
    plt.close(figure)
    print(path)


def plain(text):
    """Text with markup escaped and invalid characters replaced."""
    return text.encode("utf-8", "replace").decode().replace("$", r"\$")


def wrapped(text, inches, points=POINTS):
    """Text broken into lines that fit a width at a font size."""
    most = max(12, int(72 * inches / (0.6 * points)))
    return "\n".join(textwrap.fill(line, most, break_on_hyphens=False) for line in plain(text).split("\n"))


def set_title(figure, text):
    """Sets the title of a figure, broken into lines as needed."""
    figure.suptitle(wrapped(text, figure.get_figwidth(), POINTS + 1))


def readable_unit(unit, largest):
    """(factor, unit) for values up to `largest`: N becomes kN, MN or GN; m/s stays."""
    if unit in PREFIXED:
        for prefix, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
            if largest >= size:
                return 1 / size, prefix + unit
    return 1, unit


def labelled(text, unit):
    """A label with its unit, if it has one."""
    return f"{text} ({unit})" if unit else text
