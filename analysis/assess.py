#!/usr/bin/env python3
"""Draws an assessment: error against run time, error against steps, the largest stable step.

With --maps ARCHIVE, of a sweep with the fields speed-error and stiffness, also where in the design
space the sweep's solver is wrong, and where the scene is stiff:

  trebsweep sweep jobs/paper.cfg --output.fields "speed, status, speed-error, stiffness"
"""

import argparse
import os
import sys

import h5py
import numpy as np
from matplotlib.colors import LogNorm, SymLogNorm

from archive import Archive, plt, save, unit_text
from heatmap import PLANES, draw_values, finite_values, planes

STEPPERS = ("euler", "modified_midpoint", "rk4", "cash_karp54", "dopri5", "fehlberg78",
            "adams_bashforth_moulton", "bulirsch_stoer", "rosenbrock4")
MARKERS = "os^vD*Xph"


class Assessment:
    """The tables of an assessment, {table: {column: values}}."""

    def __init__(self, path):
        """Reads the file at `path`; ends the program with a message if it is no assessment."""
        try:
            with h5py.File(path, "r") as file:
                self.tables = {name: {column: self.values(data) for column, data in group.items()}
                               for name, group in file.items() if isinstance(group, h5py.Group)}
        except OSError as error:
            sys.exit(f"{path}: cannot be opened as an HDF5 file: {error}")
        if "accuracy" not in self.tables:
            sys.exit(f"{path}: is no assessment: it has no table accuracy")

    @staticmethod
    def values(data):
        """A column's numbers, or its texts as str."""
        return data.asstr()[...] if data.dtype.kind == "O" else data[...]

    def scenes(self):
        """Names of the scenes with a ladder of settings, in their order."""
        return list(dict.fromkeys(self.tables["accuracy"]["scene"]))

    def ladder(self, scene, stepper):
        """The rows of a stepper in a scene, {column: values}."""
        table = self.tables["accuracy"]
        chosen = (table["scene"] == scene) & (table["stepper"] == stepper)
        return {name: values[chosen] for name, values in table.items()}

    def floor(self, scene):
        """Bound of the reference's own error, m/s."""
        table = self.tables["reference"]
        return float(table["speed_bound"][table["scene"] == scene][0])


def style(stepper):
    """Colour and marker of a stepper, the same in every picture."""
    i = STEPPERS.index(stepper)
    return {"color": plt.get_cmap("tab10")(i), "marker": MARKERS[i], "markersize": 5,
            "linewidth": 1.3, "label": stepper}


def panels(scenes):
    """A figure with a panel for each scene."""
    columns = min(3, len(scenes))
    rows = -(-len(scenes) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(1 + 4.6 * columns, 1 + 3.8 * rows),
                                squeeze=False, constrained_layout=True)
    for unused in axes.flat[len(scenes):]:
        unused.set_visible(False)
    return figure, list(axes.flat)


def draw_ladders(assessment, abscissa, label, title):
    """Largest errors against a column, a panel for each scene and a line for each stepper."""
    scenes = assessment.scenes()
    figure, axes = panels(scenes)
    for panel, scene in zip(axes, scenes):
        for stepper in STEPPERS:
            rows = assessment.ladder(scene, stepper)
            good = np.isfinite(rows["error_largest"]) & (rows["different"] == 0)
            good &= rows["error_largest"] < 10
            if good.any():
                panel.plot(rows[abscissa][good], rows["error_largest"][good], **style(stepper))
        floor = assessment.floor(scene)
        if np.isfinite(floor):
            panel.axhline(floor, color="0.4", linestyle=":", linewidth=1)
            panel.text(0.99, floor, "reference", color="0.4", fontsize=8, ha="right", va="bottom",
                       transform=panel.get_yaxis_transform())
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_title(scene.replace("_", " "))
        panel.set_xlabel(label)
        panel.set_ylabel("largest error of the speed (m/s)")
        panel.grid(True, color="0.9")
    lines = {line.get_label(): line for panel in axes for line in panel.get_lines()
             if line.get_label() in STEPPERS}
    # Above the panels, where the title leaves it room.
    figure.suptitle(title + ("\n\n" if len(scenes) > 2 else "\n\n\n\n"))
    figure.legend(lines.values(), lines.keys(), loc="upper center", fontsize=9, frameon=False,
                  ncol=len(lines) if len(scenes) > 2 else 3, bbox_to_anchor=(0.5, 0.97))
    return figure


def draw_stability(assessment):
    """The largest stable step of each explicit stepper, predicted and seen, over the scenes."""
    table = assessment.tables["stability"]
    scenes = list(dict.fromkeys(table["scene"]))
    figure, panel = plt.subplots(figsize=(10, 5.5), constrained_layout=True)
    explicit = [s for s in STEPPERS if s in table["stepper"] and s != "rosenbrock4"]
    for place, stepper in enumerate(explicit):
        rows = table["stepper"] == stepper
        x = np.array([scenes.index(s) for s in table["scene"][rows]]) + (place - 2.5) * 0.12
        kind = style(stepper)
        panel.plot(x, table["stable_step"][rows], linestyle="none", color=kind["color"],
                   marker=kind["marker"], label=stepper)
        panel.plot(x, table["usable_step"][rows], linestyle="none", color=kind["color"],
                   marker=kind["marker"], fillstyle="none")
    panel.set_yscale("log")
    stiffness = [table["stiffness"][table["scene"] == scene][0] for scene in scenes]
    panel.set_xticks(range(len(scenes)),
                     [f"{s.replace('_', ' ')}\n{k:.3g} /s" for s, k in zip(scenes, stiffness)])
    panel.set_xlabel("scene, and the largest modulus of its eigenvalues")
    panel.set_ylabel("length of a step (s)")
    panel.set_title("Largest stable step by the eigenvalues (filled), and largest step seen with an "
                    "error below 10 % (open)")
    panel.grid(True, axis="y", color="0.9")
    panel.legend(fontsize=9)
    return figure


def scale(values):
    """Colours for values: of both signs, over several decades, or neither."""
    largest = np.abs(values).max() if values.size and values.any() else 1
    if values.size and values.min() < 0:
        return {"norm": SymLogNorm(largest / 1e3, vmin=-largest, vmax=largest), "cmap": "RdBu_r"}
    if values.size and values.min() < largest / 30:
        smallest = max(values.min(), largest / 1e6)
        return {"norm": LogNorm(smallest, largest), "cmap": "viridis"}
    return {"vmin": values.min() if values.size else 0, "vmax": largest, "cmap": "viridis"}


def draw_map(archive, field, title):
    """A map in its three planes through the optimum."""
    centre = archive.optimum() or {name: v[len(v) // 2] for name, v in archive.axes.items()}
    figure, panels = plt.subplots(1, 3, figsize=(15, 5), constrained_layout=True)
    parts = planes(archive, field, centre)
    style = scale(finite_values(parts))
    for axes, part, names in zip(panels, parts, PLANES):
        mesh = draw_values(axes, archive, centre, names, part, **style)
        axes.set_facecolor("0.93")
    unit = unit_text(archive.map(field).attrs.get("units", ""))
    bar = figure.colorbar(mesh, ax=panels, pad=0.01)
    bar.set_label(f"{field.replace('_', ' ')} ({unit})")
    if isinstance(mesh.norm, SymLogNorm):  # ticks near zero would lie on each other
        bar.set_ticks([t for t in bar.get_ticks()
                       if t == 0 or mesh.norm.linthresh <= abs(t) <= mesh.norm.vmax])
    figure.suptitle(title)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("assessment", metavar="ASSESSMENT", help="file of trebsweep assess")
    parser.add_argument("--maps", metavar="ARCHIVE",
                        help="of a sweep with speed-error, stiffness or both")
    parser.add_argument("-o", "--output", metavar="STEM",
                        help="pictures are STEM-precision.png and so on; default: the assessment's")
    parser.add_argument("--format", default="png", help="png, svg or pdf (default: png)")
    arguments = parser.parse_args()

    assessment = Assessment(arguments.assessment)
    stem = arguments.output or os.path.splitext(arguments.assessment)[0]
    save(draw_ladders(assessment, "seconds", "run time per design (s)", "Error against run time"),
         f"{stem}-precision.{arguments.format}")
    save(draw_ladders(assessment, "evaluations", "right-hand sides per design",
                      "Order of convergence: error against right-hand sides"),
         f"{stem}-order.{arguments.format}")
    if assessment.tables.get("stability"):
        save(draw_stability(assessment), f"{stem}-stability.{arguments.format}")
    if arguments.maps:
        archive = Archive(arguments.maps)
        for field in ("speed_error", "stiffness"):
            if field in archive.fields:
                save(draw_map(archive, field, archive.label(field)),
                     f"{stem}-{field}.{arguments.format}")


if __name__ == "__main__":
    main()
