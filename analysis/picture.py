"""What the pictures have in common: files, titles, units."""

import logging
import os
import textwrap
import warnings

from program import fail, keep, refuse  # before modules that may be missing

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of the backend)

warnings.filterwarnings("ignore", "Glyph .* missing from current font")  # of an archive's name
logging.getLogger("matplotlib").setLevel(logging.ERROR)  # else of PostScript without transparency
plt.rcParams["figure.constrained_layout.use"] = True
plt.rcParams["axes.formatter.useoffset"] = False  # it would lie on titles

FORMATS = ("png", "svg", "pdf", "eps", "ps", "jpg", "tif", "webp")
PREFIXED = ("N", "Pa", "J")  # units that take a prefix
OUTPUT_HELP = (f"the format follows the suffix ({', '.join(FORMATS)}); without a suffix PNG is "
               f"written under exactly this name; ")


def picture_format(path):
    """The format that a picture's name asks for."""
    return os.path.splitext(path)[1][1:].lower() or "png"


def check_output(path, *inputs):
    """Ends the program if no picture can be written under this name, or only over what is read."""
    if picture_format(path) not in FORMATS:
        refuse("output", path,
               f"must end in one of .{', .'.join(FORMATS)}, or have no suffix (PNG)")
    keep("output", path, *inputs)


def save(figure, path):
    """Writes a picture and prints its name. It grows where a label would leave it."""
    try:
        with open(path, "wb") as file:
            figure.savefig(file, format=picture_format(path), dpi=150, bbox_inches="tight",
                           pad_inches=0.08)
    except OSError as error:
        fail(f"{path}: cannot be written: {error.strerror or error}")
    plt.close(figure)
    print(path)


def plain(text):
    """Text with neither markup nor what no font can show."""
    return text.encode("utf-8", "replace").decode().replace("$", r"\$")


def wrapped(text, inches, points=12):
    """Text in lines that fit a width, if set in a size."""
    most = max(20, int(72 * inches / (0.58 * points)))
    return "\n".join(textwrap.fill(line, most) for line in plain(text).split("\n"))


def set_title(figure, text):
    """Puts a title above a figure, in as many lines as it takes."""
    figure.suptitle(wrapped(text, figure.get_figwidth()))


def readable_unit(unit, largest):
    """(factor, unit) for values up to `largest`: N, kN, MN or GN, but m/s stays."""
    if unit in PREFIXED:
        for prefix, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
            if largest >= size:
                return 1 / size, prefix + unit
    return 1, unit


def labelled(text, unit):
    """A label: what it is, and its unit if it has one."""
    return f"{text} ({unit})" if unit else text
