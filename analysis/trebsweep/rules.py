"""Tests rules of thumb: what it costs to follow them, in every scene of a study.

A rule is an expression that is true of the designs that follow it, such as "r1 < r2". The best
design of a scene's lattice is compared with the best of those that follow the rule; the cost is the
lost fraction of the value, where the best value is positive. The value is the objective, or another
expression. Expressions are of

  r1, r2, r3                  the lengths of a design, m
  speed, arm_angle, ...       the fields stored as maps
  projectile_mass, ...        the numbers of [scene]
  + - * / **                  numbers, pi, and the functions abs, sqrt, sin, cos
  < <= > >= == !=             comparisons, which & | ~ combine if they are in parentheses

An outer axis given with --free is chosen with the design, as a length is: the best design is that
of all its values, and rules may relate it to lengths.

Prints what each rule costs in the scenes and, of at most two outer axes, the best design of each
scene. The picture shows the cost against these axes; its colours end at 40 %, as an arrow of the
colour bar says where costs are higher.

  treb-plot rules rules.h5 --rule "r1 < r2" --rule "r2 + r3 > 1.45" --at beam-side=0.1 -o rules.png
  treb-plot rules hinged.h5 --value "range / r1" --free counterweight-hanger --rule "abs(r3/r2 - 1) < 0.05"
"""

import numpy as np
import pandas

from .accessor import key_of
from .expressions import Expression
from .picture import add_output, check_output, plt, save, set_title, size, wrapped
from .program import Parser, refuse
from .scenes import load, select
from .study import axis_label, set_scale

TOP = 40  # %: the end of the colour scale, beyond which the colour bar has an arrow


def examine(scene, value, among, shown, rules):
    """Of a scene: the best value, the expressions shown of its design, and the best value with
    each rule; NaN where there is no design."""
    values = value.values(scene.data)
    considered = np.isfinite(values)
    if among:
        considered &= among.flags(scene.data)
    values = np.where(considered, values, -np.inf)
    best = np.unravel_index(np.argmax(values), values.shape)
    follow = [np.max(values, where=rule.flags(scene.data), initial=-np.inf) for rule in rules]
    row = np.array([values[best], *(text.values(scene.data)[best] for text in shown), *follow])
    return np.where(np.isneginf(row) | np.isneginf(values[best]), np.nan, row)


class Findings:
    """What was found in the scenes, as arrays over the outer axes that are not free.

    axes    {dataset: values} of these outer axes
    best    the best values
    shown   [values of an expression at the best design]
    costs   [lost fractions of the best value with a rule; NaN where no design follows it, or where
            the best value is not positive]
    """

    def __init__(self, archive, free, value, among, shown, rules):
        archive = archive.first(*free)
        rows = np.array([examine(scene, value, among, shown, rules)
                         for scene in archive.each_scene()])
        kept = archive.outer_shape[len(free):]
        table = np.moveaxis(rows.reshape(-1, *kept, rows.shape[1]), -1, 0)  # (column, free, kept)
        best = np.argmax(np.nan_to_num(table[0], nan=-np.inf), axis=0)
        chosen = np.take_along_axis(table[:1 + len(shown)], best[np.newaxis, np.newaxis], 1)[:, 0]
        self.axes = {name: values for name, values in archive.outer_axes.items()
                     if name not in free}
        self.best, self.shown = chosen[0], chosen[1:]
        follow = np.fmax.reduce(table[1 + len(shown):], axis=1)
        self.costs = np.where(self.best > 0, 1 - follow / self.best, np.nan)

    def scene_text(self, index):
        """The values of the outer axes in a scene, as text."""
        return ", ".join(f"{key_of(name)} = {values[i]:.6g}"
                         for (name, values), i in zip(self.axes.items(), index))


def print_scenes(findings, shown):
    """Prints the best design of each scene, and the cost of each rule."""
    outer = np.meshgrid(*findings.axes.values(), indexing="ij") if findings.axes else ()
    columns = [*((key_of(name), values, "{:.6g}") for name, values in zip(findings.axes, outer)),
               ("best", findings.best, "{:.6g}"),
               *((text.text, values, "{:.4g}") for text, values in zip(shown, findings.shown)),
               *((f"rule {n}", cost, "{:.1%}") for n, cost in enumerate(findings.costs, 1))]
    table = pandas.DataFrame({name: np.ravel(values) for name, values, _ in columns})
    print(table.to_string(index=False, na_rep="-", formatters={name: form.format for name, _, form in columns}))


def print_rules(findings, rules):
    """Prints what each rule costs in the scenes."""
    scenes = np.count_nonzero(findings.best > 0)
    for n, (rule, cost) in enumerate(zip(rules, findings.costs), 1):
        print(f"rule {n}: {rule.text}")
        known = np.isfinite(cost).sum()
        if known < scenes:
            print(f"  no design follows it in {scenes - known} of {scenes} scenes")
        if known:
            worst = np.unravel_index(np.nanargmax(cost), cost.shape)
            print(f"  within 1 % of the best in {np.count_nonzero(cost <= 0.01)} of {scenes} "
                  f"scenes; costs {np.nanmedian(cost):.1%} in the median and at most "
                  f"{cost[worst]:.1%}" + (f", at {findings.scene_text(worst)}" if worst else ""))


def label_cells(axis, values):
    """Labels an axis of equal cells with the values of an outer axis."""
    shown = range(0, len(values), -(-len(values) // 12))
    axis.set_ticks(shown, labels=[f"{values[i]:.4g}" for i in shown])


def draw_cells(axes, cost):
    """Draws costs in % as cells with their values, "-" without one; returns the image, for the
    colour bar."""
    for place, percent in np.ndenumerate(cost):
        axes.text(*place, "-" if np.isnan(percent) else f"{percent:.{int(percent < 9.95)}f}", ha="center", va="center",
                  fontsize=8, color="white" if percent > 0.6 * TOP else "black")
    return axes.imshow(cost.T, cmap="Oranges", vmin=0, vmax=TOP, origin="lower", aspect="auto")


def draw(archive, findings, rules):
    """The figure of the costs against one or two outer axes, a panel per rule."""
    (x_name, x), *others = findings.axes.items()
    columns = min(len(rules), 2) if others else 1
    rows = -(-len(rules) // columns)
    figure, panels = plt.subplots(rows, columns, squeeze=False, sharex=True, sharey=True,
                                  figsize=size(0.1 + 0.35 * rows))
    for unused in panels.flat[len(rules):]:
        unused.set_visible(False)
    for axes, rule, cost in zip(panels.flat, rules, 100 * findings.costs):
        axes.set_title(wrapped(rule.text, figure.get_figwidth() / columns))
        if others:
            image = draw_cells(axes, cost)
            label_cells(axes.xaxis, x)
            label_cells(axes.yaxis, others[0][1])
        else:
            axes.plot(x, cost, marker="o")
            axes.grid(True, color="0.9")
            set_scale(axes.xaxis, x)
    if others:
        beyond = np.nanmax(100 * findings.costs, initial=0) > TOP
        bar = figure.colorbar(image, ax=panels, pad=0.01, extend="max" if beyond else "neither")
        bar.set_label(f"cost (%){f'; arrow: more than {TOP} %' if beyond else ''}")
    figure.supxlabel(axis_label(archive, x_name))
    figure.supylabel(axis_label(archive, others[0][0]) if others else "cost (%)")
    none = "; -: no design follows it" if others and np.isnan(findings.costs).any() else ""
    set_title(figure, f"{archive.name()}: % of the best value lost by following a rule{none}")
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("archive", metavar="ARCHIVE", help="archive of a study with maps")
    for option, what in (
            ("--rule", "a rule, true of the designs that follow it; may be repeated"),
            ("--show", "prints this of the best designs; may be repeated")):
        parser.add_argument(option, metavar="EXPRESSION", action="append", default=[], help=what)
    parser.add_argument("--value", metavar="EXPRESSION",
                        help="what is largest for the best design (default: the objective)")
    parser.add_argument("--among", metavar="EXPRESSION",
                        help="true of the designs to consider (default: all that were released)")
    parser.add_argument("--free", metavar="KEY", action="append", default=[],
                        help="an outer axis that is chosen with the design; may be repeated")
    parser.add_scene(what="examine only the scenes with this value")
    add_output(parser, "none is drawn")
    arguments = parser.parse_args()

    if arguments.output:
        check_output(arguments.output, arguments.archive)
    archive = select(load(arguments.archive), arguments.at)
    free = list(dict.fromkeys(key.replace("-", "_") for key in arguments.free))
    for name in free:
        if name not in archive.outer:
            refuse("free", key_of(name), "must be an outer axis that --at leaves: " + (
                ", ".join(map(key_of, archive.outer)) or "none"))
    value = Expression("value", arguments.value or archive.field(archive.objective[0]))
    rules, shown = ([Expression(option, text) for text in texts] for option, texts in (
        ("rule", arguments.rule), ("show", arguments.show)))
    axes = len(archive.outer) - len(free)
    if arguments.output and not (rules and 1 <= axes <= 2):
        refuse("output", arguments.output, "needs a rule, and one or two outer axes that neither "
                                           f"--at nor --free takes, not {axes}")
    among = arguments.among and Expression("among", arguments.among)
    findings = Findings(archive, free, value, among, shown, rules)
    if axes <= 2:
        print_scenes(findings, shown)
    print_rules(findings, rules)
    if arguments.output:
        save(draw(archive, findings, rules), arguments.output)
