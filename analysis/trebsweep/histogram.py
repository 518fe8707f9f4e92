"""Draws how often the values of a map occur among the designs of an archive.

The field is a map of numbers or an expression; all scenes of a study count, or those of --at. --log
counts on a logarithmic scale. The quartiles are printed.

  treb-plot histogram accurate.h5                      -> accurate-histogram.png
  treb-plot histogram loads.h5 --field "range / r2" --among "slack == 1"
"""

import numpy as np

from .accessor import stem
from .importance import describe
from .pareto import sample
from .picture import COLOURS, add_output, check_output, labelled, plt, readable_unit, save, set_title, size, wrapped
from .program import Parser, fail
from .scenes import load, select


def draw(archive, field, values, log):
    """The figure of the numbers of designs against a field's values."""
    text, unit = describe(archive, field)
    factor, unit = readable_unit(unit, np.abs(values).max())
    figure, axes = plt.subplots(figsize=size(0.5))
    axes.hist(factor * values, bins=100, color=COLOURS[0], log=log)
    axes.axvline(factor * np.median(values), color="black", linestyle="--", label="median")
    axes.set_xlabel(wrapped(labelled(text, unit), figure.get_figwidth() - 1))
    axes.set_ylabel("designs")
    axes.legend(loc="best")
    progress = "" if archive.complete else f"; {archive.progress()}"
    set_title(figure, f"{archive.name()}: {text} of {values.size} designs{progress}")
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("archive", metavar="ARCHIVE", help="archive with maps, or FILE.partial, an unfinished one")
    parser.add_argument("--field", default="speed", help="a map of numbers, or an expression (default: speed)")
    parser.add_scene(what="use only the scenes with this value")
    parser.add_argument("--among", metavar="EXPRESSION", help="true of the designs to consider (default: all)")
    parser.add_argument("--log", action="store_true", help="count on a logarithmic scale")
    add_output(parser, "the archive's name with -histogram.png")
    arguments = parser.parse_args()

    output = arguments.output or f"{stem(arguments.archive, arguments.at)}-histogram.png"
    check_output(output, arguments.archive)
    archive = select(load(arguments.archive), arguments.at)
    field = archive.expression(arguments.field)
    values = sample(archive, [field.text], arguments.among, every=True)[0]
    if not values.size:
        fail(f"{archive.path}: no design has a value")
    quartiles = np.percentile(values, [0, 25, 50, 75, 100])
    texts = [f"{value:.6g}" for value in quartiles]
    print(f"{values.size} designs: least {texts[0]}, quartiles {', '.join(texts[1:4])}, largest {texts[4]} "
          f"{describe(archive, field)[1]}".rstrip())
    save(draw(archive, field, values, arguments.log), output)
