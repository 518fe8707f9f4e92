#!/usr/bin/env python3
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

  rules.py rules.h5 --rule "r1 < r2" --rule "r2 + r3 > 1.45" --at beam-side=0.1 -o rules.png
  rules.py hinged.h5 --value "range / r1" --free counterweight-hanger --rule "abs(r3/r2 - 1) < 0.05"
"""

import ast

from program import Parser, refuse, run  # before modules that may be missing

import numpy as np

from archive import AXES, Archive
from picture import OUTPUT_HELP, check_output, plt, save, set_title, wrapped
from study import axis_label, key_of, set_scale

TOP = 40  # %: the end of the colour scale, beyond which the colour bar has an arrow

FUNCTIONS = {"abs": np.abs, "sqrt": np.sqrt, "sin": np.sin, "cos": np.cos}
OPERATORS = {ast.Add: np.add, ast.Sub: np.subtract, ast.Mult: np.multiply, ast.Div: np.divide,
             ast.Pow: np.power, ast.USub: np.negative, ast.Lt: np.less, ast.LtE: np.less_equal,
             ast.Gt: np.greater, ast.GtE: np.greater_equal, ast.Eq: np.equal,
             ast.NotEq: np.not_equal, ast.BitAnd: np.bitwise_and, ast.BitOr: np.bitwise_or,
             ast.Invert: np.invert}


def operation(node):
    """What a node of a syntax tree computes, a function or None, and the nodes of its operands."""
    if isinstance(node, ast.BinOp):
        return OPERATORS.get(type(node.op)), [node.left, node.right]
    if isinstance(node, ast.UnaryOp):
        return OPERATORS.get(type(node.op)), [node.operand]
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        return OPERATORS.get(type(node.ops[0])), [node.left, *node.comparators]
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and (
            len(node.args) == 1 and not node.keywords):
        return FUNCTIONS.get(node.func.id), node.args
    return None, []


class Expression:
    """An expression of the command line, and the option that it was given by. It is evaluated from
    its syntax tree, so that it can do nothing else than compute."""

    def __init__(self, option, text):
        self.option, self.text = option, text
        try:
            self.tree = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            self.refuse(f"must be an expression: {error.args[0] if error.args else 'too long'}")

    def refuse(self, allowed):
        """Ends the program with the expression and what is allowed."""
        refuse(self.option, self.text, allowed)

    def evaluate(self, node, scene, known):
        """The value of a node, a number or an array that broadcasts to (r1, r3, r2). `known` are
        the values of all names that are not maps."""
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return float(node.value)
        if isinstance(node, ast.Name) and node.id in known:
            return known[node.id]
        if isinstance(node, ast.Name) and node.id in scene.fields:
            return scene.read(node.id).astype(float)
        if isinstance(node, ast.Name):
            names = ", ".join(sorted({*known, *scene.fields}))
            self.refuse(f"{node.id} must be one of {names}")
        function, operands = operation(node)
        if function is None:
            self.refuse(f"must not contain {ast.unparse(node)}; allowed are numbers, names, "
                        f"{', '.join(FUNCTIONS)}, + - * / **, comparisons of two values, and & | ~ "
                        "between comparisons in parentheses")
        return function(*(self.evaluate(operand, scene, known) for operand in operands))

    def result(self, scene):
        """The value for the designs of a scene, an array (r1, r3, r2) of numbers or flags."""
        known = {"pi": np.pi, **scene_numbers(scene), **lengths(scene)}
        try:
            with np.errstate(all="ignore"):
                return np.broadcast_to(self.evaluate(self.tree, scene, known), scene.shape)
        except TypeError:
            self.refuse("& | ~ must combine comparisons in parentheses, and + - * / ** numbers")
        except (OverflowError, RecursionError) as error:
            self.refuse(f"cannot be evaluated: {error}")

    def values(self, scene):
        """The same as numbers; flags are 0 and 1."""
        return self.result(scene).astype(float)

    def flags(self, scene):
        """The same as flags; ends the program unless the expression is true or false."""
        flags = self.result(scene)
        if flags.dtype != bool:
            self.refuse("must be true or false, such as r1 < r2")
        return flags


def scene_numbers(scene):
    """{name: value} of the keys of [scene] that are numbers."""
    numbers = {}
    for (section, key), text in scene.job.items():
        try:
            if section == "scene":
                numbers[key.replace("-", "_")] = float(text)
        except ValueError:
            pass  # a word
    return numbers


def lengths(scene):
    """{axis: lengths of the designs, m}, arrays that broadcast to (r1, r3, r2)."""
    return dict(zip(AXES, np.ix_(*(scene.axes[name] for name in AXES))))


def examine(scene, value, among, shown, rules):
    """Of a scene: the best value, the expressions shown of its design, and the best value with
    each rule; NaN where there is no design."""
    values = value.values(scene)
    considered = np.isfinite(values)
    if among:
        considered &= among.flags(scene)
    values = np.where(considered, values, -np.inf)
    best = np.unravel_index(np.argmax(values), values.shape)
    follow = [np.max(values, where=rule.flags(scene), initial=-np.inf) for rule in rules]
    row = np.array([values[best], *(text.values(scene)[best] for text in shown), *follow])
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
        for name in free:
            archive = archive.with_first(name)
        rows = np.array([examine(scene, value, among, shown, rules)
                         for scene in archive.each_scene()])
        kept = archive.scenes.shape[len(free):]
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
    columns = [*((key_of(name), values, ".6g") for name, values in zip(findings.axes, outer)),
               ("best", findings.best, ".6g"),
               *((text.text, values, ".4g") for text, values in zip(shown, findings.shown)),
               *((f"rule {n}", cost, ".1%") for n, cost in enumerate(findings.costs, 1))]
    texts = [[name, *("-" if np.isnan(value) else format(value, form)
                      for value in np.ravel(values))] for name, values, form in columns]
    widths = [max(map(len, column)) for column in texts]
    for row in zip(*texts):
        print("  ".join(text.rjust(width) for text, width in zip(row, widths)))


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
        axes.text(*place, "-" if np.isnan(percent) else f"{percent:.1f}", ha="center", va="center",
                  fontsize=8, color="white" if percent > 0.6 * TOP else "black")
    return axes.imshow(cost.T, cmap="Oranges", vmin=0, vmax=TOP, origin="lower", aspect="auto")


def draw(archive, findings, rules):
    """The figure of the costs against one or two outer axes, a panel per rule."""
    (x_name, x), *others = findings.axes.items()
    columns = min(len(rules), 2) if others else 1
    rows = -(-len(rules) // columns)
    figure, panels = plt.subplots(rows, columns, squeeze=False, sharex=True, sharey=True,
                                  figsize=(1 + 4.5 * columns, 1 + 3 * rows))
    for unused in panels.flat[len(rules):]:
        unused.set_visible(False)
    for axes, rule, cost in zip(panels.flat, rules, 100 * findings.costs):
        axes.set_title(wrapped(rule.text, 4.5, 10), fontsize=10)
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
    parser.add_argument("-o", "--output", metavar="PICTURE",
                        help=OUTPUT_HELP + "default: none is drawn")
    arguments = parser.parse_args()

    if arguments.output:
        check_output(arguments.output, arguments.archive)
    archive = Archive(arguments.archive).select(arguments.at)
    free = list(dict.fromkeys(key.replace("-", "_") for key in arguments.free))
    for name in free:
        if name not in archive.outer_axes:
            refuse("free", key_of(name), "must be an outer axis that --at leaves: " + (
                ", ".join(map(key_of, archive.outer_axes)) or "none"))
    value = Expression("value", arguments.value or archive.field(archive.objective[0]))
    rules, shown = ([Expression(option, text) for text in texts] for option, texts in (
        ("rule", arguments.rule), ("show", arguments.show)))
    axes = len(archive.outer_axes) - len(free)
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


if __name__ == "__main__":
    run(main)
