"""Draws an assessment: error against run time, error against steps, the largest stable step.

The pictures are STEM-precision, STEM-order and STEM-stability. --maps ARCHIVE, the archive of a
sweep with the fields speed-error and stiffness, adds STEM-speed_error and STEM-stiffness: maps of
the error of the sweep's solver and of the stiffness over the design space.

Arrows at the upper edge mark solvers with an error above 10 m/s, or a design whose outcome is not
the true one; lines break there.

  treb-plot assess assess.h5                                  -> assess-precision.png, ...
  trebsweep sweep jobs/paper.cfg --output.fields "speed, status, speed-error, stiffness"
  treb-plot assess assess.h5 --maps paper.h5 --format svg
"""

import os

import h5py
import numpy as np

from .accessor import stem
from .backend import open_file, reading
from .maps import draw, finite_values, middle, scaled, slices, views
from .picture import COLOURS, FORMATS, check_output, labelled, plt, save, set_title, size
from .program import Parser, fail, limited_cpu_time, note, refuse
from .scenes import load, only

STEPPERS = ("euler", "modified_midpoint", "rk4", "cash_karp54", "dopri5", "fehlberg78",
            "vern7", "vern8", "adams_bashforth_moulton", "bulirsch_stoer", "rosenbrock4")
MARKERS = "os^vD*XphP<>"
LARGEST = 10  # m/s: the largest error that is drawn
BEYOND = r"$\uparrow$"  # marker of larger ones


class Assessment:
    """The tables of an assessment, {table: {column: values}}."""

    def __init__(self, path):
        """Reads the file at `path`; ends the program with a message if it is not an assessment."""
        with limited_cpu_time(), open_file(path) as file, reading(path, "is damaged"):
            self.tables = {name: {column: self.values(data) for column, data in group.items()}
                           for name, group in file.items() if isinstance(group, h5py.Group)}
        if not {"accuracy", "reference"} <= set(self.tables):
            fail(f"{path}: is not an assessment: it has no tables accuracy and reference")

    @staticmethod
    def values(data):
        """The values of a column: numbers or str."""
        return data.asstr()[...] if data.dtype.kind == "O" else data[...]

    def scenes(self):
        """Names of the scenes with a series of step sizes or tolerances, in file order."""
        return list(dict.fromkeys(self.tables["accuracy"]["scene"]))

    def steppers(self):
        """{name: number} of the steppers; those in STEPPERS always have the same number.

        Variants of a stepper, such as "euler, window", are not drawn."""
        found = [name for name in self.tables["accuracy"]["stepper"] if "," not in name]
        names = dict.fromkeys([*STEPPERS, *found])
        return {name: i for i, name in enumerate(names) if name in found}

    def measurements(self, scene, stepper):
        """{column: values} of a stepper in a scene, a row for each step size or tolerance."""
        table = self.tables["accuracy"]
        chosen = (table["scene"] == scene) & (table["stepper"] == stepper)
        return {name: values[chosen] for name, values in table.items()}

    def reference_error(self, scene):
        """Bound on the error of the reference itself, m/s."""
        table = self.tables["reference"]
        return float(table["speed_bound"][table["scene"] == scene][0])


def style(stepper, number):
    """Colour, marker and label of a stepper."""
    return {"color": COLOURS[number % len(COLOURS)], "marker": MARKERS[number % len(MARKERS)],
            "linestyle": "-" if number < len(COLOURS) else "--", "markersize": 5, "linewidth": 1.2, "label": stepper}


def panels(scenes):
    """A figure with a panel for each scene."""
    columns = min(3, len(scenes))
    rows = -(-len(scenes) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=size(0.2 + 0.3 * rows), squeeze=False)
    for unused in axes.flat[len(scenes):]:
        unused.set_visible(False)
    return figure, list(axes.flat)


def draw_line(panel, x, rows, kind):
    """Draws the errors of a stepper against x, and arrows for those that are beyond the axis."""
    with np.errstate(invalid="ignore"):
        good = (rows["error_largest"] < LARGEST) & (rows["different"] == 0)
    if good.any():
        panel.plot(x, np.where(good, rows["error_largest"], np.nan), **kind)
    if not good.all():
        panel.plot(x[~good], np.full((~good).sum(), 0.96), color=kind["color"], marker=BEYOND,
                   markersize=8, linestyle="none", transform=panel.get_xaxis_transform())


def draw_errors(assessment, abscissa, label, title):
    """Largest error against a column: a panel for each scene, a line for each stepper."""
    scenes = assessment.scenes()
    figure, axes = panels(scenes)
    for panel, scene in zip(axes, scenes):
        for stepper, number in assessment.steppers().items():
            rows = assessment.measurements(scene, stepper)
            draw_line(panel, rows[abscissa], rows, style(stepper, number))
        floor = assessment.reference_error(scene)
        if np.isfinite(floor):
            panel.axhline(floor, color="0.4", linestyle=":", linewidth=1)
            panel.text(0.99, floor, "reference", color="0.4", ha="right", va="bottom",
                       transform=panel.get_yaxis_transform())
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_title(scene.replace("_", " "))
        panel.set_xlabel(label)
        panel.set_ylabel("largest error of the speed (m/s)")
        panel.grid(True, color="0.9")
    lines = {line.get_label(): line for panel in axes for line in panel.get_lines()
             if line.get_label() in assessment.steppers()}
    if any(line.get_marker() == BEYOND for panel in axes for line in panel.get_lines()):
        title += f"; \u2191 an error above {LARGEST} m/s, or an outcome that is not the true one"
    # The legend goes above the panels, in empty lines of the title.
    columns = max(1, min(len(lines), 3 * len(scenes)))
    figure.suptitle(title + "\n" * (1 - -len(lines) // columns))
    figure.legend(lines.values(), lines.keys(), loc="upper center",
                  ncol=columns, bbox_to_anchor=(0.5, 1 - 0.25 / figure.get_figheight()))
    return figure


def draw_stability(assessment, title):
    """The largest stable step of each explicit stepper in each scene, predicted and measured."""
    table = assessment.tables["stability"]
    scenes = list(dict.fromkeys(table["scene"]))
    figure, panel = plt.subplots(figsize=size(0.6))
    numbers = assessment.steppers()
    explicit = [s for s in numbers if s in table["stepper"] and s != "rosenbrock4"]
    for column, stepper in enumerate(explicit):
        rows = table["stepper"] == stepper
        offset = 0.12 * (column - (len(explicit) - 1) / 2)
        x = np.array([scenes.index(s) for s in table["scene"][rows]]) + offset
        kind = style(stepper, numbers[stepper])
        panel.plot(x, table["stable_step"][rows], linestyle="none", color=kind["color"],
                   marker=kind["marker"], label=stepper)
        panel.plot(x, table["usable_step"][rows], linestyle="none", color=kind["color"],
                   marker=kind["marker"], fillstyle="none")
    panel.set_yscale("log")
    stiffness = [table["stiffness"][table["scene"] == scene][0] for scene in scenes]
    panel.set_xlim(-0.5, len(scenes) - 0.5)
    panel.set_xticks(range(len(scenes)),
                     [f"{s.replace('_', ' ')}\n{k:.3g} /s" for s, k in zip(scenes, stiffness)])
    panel.set_xlabel("scene, with the largest modulus of its eigenvalues")
    panel.set_ylabel("step size (s)")
    set_title(figure, f"{title}: largest stable step by the eigenvalues (filled), and largest step with a "
                      "measured error below 10 % (open)")
    panel.grid(True, axis="y", color="0.9")
    panel.legend(ncol=2)
    return figure


def colours(values):
    """Colour map and norm for values of both signs, over several decades, or neither."""
    norms = plt.matplotlib.colors
    largest = np.abs(values).max() if values.size and values.any() else 1
    if values.size and values.min() < 0:
        norm = norms.SymLogNorm(largest / 1e3, vmin=-largest, vmax=largest)
        return {"norm": norm, "cmap": "RdBu_r"}
    if values.size and values.min() < largest / 30:
        smallest = max(values.min(), largest / 1e6)
        return {"norm": norms.LogNorm(smallest, largest), "cmap": "viridis"}
    return {"vmin": values.min() if values.size else 0, "vmax": largest, "cmap": "viridis"}


def draw_map(archive, field):
    """The figure of a map in the planes through the optimum."""
    optimum = archive.optimum()
    centre = optimum[0] if optimum else middle(archive)
    values, unit = scaled(archive, field, slices(archive, field, centre))
    title = f"{archive.name()}: {labelled(archive.long_name(field), unit)}, through the optimum"
    if not archive.complete:
        title += f"; {archive.progress()}"
    return draw(archive, values, centre, title, labelled(field.replace("_", " "), unit),
                colours(finite_values(values)), background="0.93")


def draw_maps(path, at, picture_stem, form):
    """Writes the maps of an archive's speed error and stiffness, those that it has."""
    archive = only(load(path), at)
    fields = [name for name in ("speed_error", "stiffness") if name in archive.fields]
    if not fields:
        fail(f"{path}: has no map speed_error or stiffness; it has {', '.join(archive.fields)}")
    if not views(archive):
        note(f"{path}: holds a single design; no map is drawn")
        return
    for field in fields:
        name = f"{picture_stem}-{field}.{form}"
        check_output(name, path)
        save(draw_map(archive, field), name)


def main():
    parser = Parser(__doc__)
    parser.add_argument("assessment", metavar="ASSESSMENT",
                        help="file written by 'trebsweep assess'")
    parser.add_argument("--maps", metavar="ARCHIVE",
                        help="archive of a sweep with the field speed-error, stiffness or both")
    parser.add_scene(what="the scene to read from an archive of a study")
    parser.add_argument("-o", "--output", metavar="STEM",
                        help="beginning of the pictures' names (default: the assessment's name)")
    parser.add_argument("--format", default="png", help=f"{', '.join(FORMATS)} (default: png)")
    arguments = parser.parse_args()

    form = arguments.format
    if form not in FORMATS:
        refuse("format", form, f"must be one of {', '.join(FORMATS)}")
    assessment = Assessment(arguments.assessment)
    name = arguments.output or stem(arguments.assessment)
    precision, order, stability = outputs = [f"{name}-{what}.{form}"
                                             for what in ("precision", "order", "stability")]
    for output in outputs:
        check_output(output, arguments.assessment)
    title = os.path.basename(stem(arguments.assessment))
    with reading(arguments.assessment, "is damaged"):
        save(draw_errors(assessment, "seconds", "run time per design (s)",
                          f"{title}: error against run time"), precision)
        save(draw_errors(assessment, "evaluations", "right-hand sides per design",
                          f"{title}: order of convergence, error against right-hand sides"), order)
        if assessment.tables.get("stability"):
            save(draw_stability(assessment, title), stability)
    if arguments.maps:
        draw_maps(arguments.maps, arguments.at, name, form)
