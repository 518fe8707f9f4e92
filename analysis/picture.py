"""Files, titles and units of the pictures."""

import functools
import logging
import os
import textwrap
import warnings

import program
from program import fail, refuse  # before modules that may be missing


@functools.cache
def import_pyplot():
    """matplotlib.pyplot, set up to write files."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    warnings.filterwarnings("ignore", "Glyph .* missing from ")  # in an archive's name
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # PostScript lacks transparency
    pyplot.rcParams["svg.hashsalt"] = "trebsweep"  # the same picture has the same bytes
    pyplot.rcParams["figure.constrained_layout.use"] = True
    pyplot.rcParams["axes.formatter.useoffset"] = False  # the offset would overlap titles
    return pyplot


class Pyplot:
    """matplotlib.pyplot, imported at its first use: errors in the input are reported at once."""

    def __getattr__(self, name):
        return getattr(import_pyplot(), name)


plt = Pyplot()

FORMATS = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF", "eps": b"%!PS", "ps": b"%!PS",
           "jpg": b"\xff\xd8", "tif": b"II*", "webp": b"RIFF"}  # with what their files begin
PREFIXED = ("N", "Pa", "J")  # units that take a prefix
OUTPUT_HELP = (f"the suffix selects the format ({', '.join(FORMATS)}); without a suffix a PNG is "
               f"written under exactly this name; ")


def picture_format(path):
    """The format that belongs to the suffix of a picture's name."""
    return os.path.splitext(path)[1][1:].lower() or "png"


def is_picture(path):
    """Whether a file is empty, or a picture of the format that belongs to its name."""
    with open(path, "rb") as file:
        start = file.read(8)
    return not start or start.startswith(FORMATS[picture_format(path)])


def check_output(path, *inputs):
    """Ends the program if the name has no format of pictures, or is that of an input file or of any
    other file than a picture."""
    if picture_format(path) not in FORMATS:
        refuse("output", path,
               f"must end in one of .{', .'.join(FORMATS)}, or have no suffix (PNG)")
    program.check_output("output", path, inputs, not os.path.isfile(path) or is_picture(path),
                         f"exists and is no {picture_format(path).upper()}; name another file")


def save(figure, path, is_page=False):
    """Writes a picture, enlarged to hold all labels unless it is a page, and prints its name."""
    try:
        with open(path, "wb") as file:
            form = picture_format(path)
            undated = {"metadata": {"Date": None}} if form == "svg" else {}
            enlarged = {} if is_page else {"bbox_inches": "tight", "pad_inches": 0.08}
            figure.savefig(file, format=form, dpi=150, **enlarged, **undated)
    except OSError as error:
        fail(f"{path}: cannot be written: {error.strerror or error}")
    plt.close(figure)
    print(path)


def plain(text):
    """Text with markup escaped and invalid characters replaced."""
    return text.encode("utf-8", "replace").decode().replace("$", r"\$")


def wrapped(text, inches, points=12):
    """Text broken into lines that fit a width at a font size."""
    most = max(20, int(72 * inches / (0.58 * points)))
    return "\n".join(textwrap.fill(line, most) for line in plain(text).split("\n"))


def set_title(figure, text):
    """Sets the title of a figure, broken into lines as needed."""
    figure.suptitle(wrapped(text, figure.get_figwidth()))


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
