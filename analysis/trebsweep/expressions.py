"""Expressions of lengths, maps and numbers of the scene, over the designs of a dataset."""

from __future__ import annotations

import ast
import math
import re
from typing import Any, NoReturn

import numpy as np
import xarray

from .backend import AXES
from .program import key_of, refuse

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
    """An expression, and the option that it was given by. It is evaluated from its syntax tree, so
    that it can do nothing else than compute. Words may be joined by - where Python allows only _."""

    def __init__(self, option: str, text: str):
        self.option, self.text = option, text
        self.parse(text)

    def parse(self, text: str) -> ast.expr:
        """The syntax tree of a text; refused if it is no expression."""
        try:
            return ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            return self.refuse(f"must be an expression: {error.args[0] if error.args else 'too long'}")

    def joined(self, names) -> str:
        """The text with _ for the - within names."""
        hyphens = sorted((key_of(name) for name in names if "_" in name), key=len, reverse=True)
        return re.sub(rf"(?<![\w-])-?({'|'.join(map(re.escape, hyphens))})(?![\w])" if hyphens else "$^",
                      lambda found: found[0][:-len(found[1])] + found[1].replace("-", "_"), self.text)

    def refuse(self, allowed: str) -> NoReturn:
        """Refuses the expression with what is allowed."""
        refuse(self.option, self.text, allowed)

    def evaluate(self, node, known, maps):
        """The value of a node. `known` are the values of all names that are not `maps`."""
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return float(node.value)
        if isinstance(node, ast.Name) and node.id in known:
            return known[node.id]
        if isinstance(node, ast.Name) and node.id in maps:
            return maps[node.id].values.astype(float)
        if isinstance(node, ast.Name):
            names = ", ".join(sorted({*known, *maps}))
            self.refuse(f"{node.id} must be one of {names}")
        function, operands = operation(node)
        if function is None:
            self.refuse(f"must not contain {ast.unparse(node)}; allowed are numbers, names, "
                        f"{', '.join(FUNCTIONS)}, + - * / **, comparisons of two values, and & | ~ "
                        "between comparisons in parentheses")
        return function(*(self.evaluate(operand, known, maps) for operand in operands))

    def result(self, scene: xarray.Dataset) -> np.ndarray:
        """The value for the designs of a scene, an array (r1, r3, r2) of numbers or flags."""
        known: dict[str, Any] = {"pi": math.pi, **scene.treb.numbers}
        known.update(zip(AXES, np.ix_(*(scene[name].values for name in AXES))))
        maps = {name: scene[name] for name in scene.treb.fields}
        try:
            with np.errstate(all="ignore"):
                value = self.evaluate(self.parse(self.joined([*known, *maps])), known, maps)
                return np.broadcast_to(value, [scene.sizes[name] for name in AXES])
        except TypeError:
            self.refuse("& | ~ must combine comparisons in parentheses, and + - * / ** numbers")
        except (OverflowError, RecursionError) as error:
            self.refuse(f"cannot be evaluated: {error}")

    def values(self, scene: xarray.Dataset) -> np.ndarray:
        """The same as numbers; flags are 0 and 1."""
        return self.result(scene).astype(float)

    def flags(self, scene: xarray.Dataset) -> np.ndarray:
        """The same as flags; refuses the expression unless it is true or false."""
        flags = self.result(scene)
        if flags.dtype != bool:
            self.refuse("must be true or false, such as r1 < r2")
        return flags
