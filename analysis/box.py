"""Finds the full box of a lattice with the most designs: one in which every design has a value."""

import heapq
from collections import namedtuple

import numpy as np

MOST_STEPS = 20000  # of the search

# lower and upper: the indices of the box's first cell, and those after its last. most: how many
# cells a full box has at most, which is how many this one has if it is known to be the largest.
Box = namedtuple("Box", "lower upper most")


def cells(lower, upper):
    """The number of cells of a box."""
    return int(np.prod(np.maximum(np.subtract(upper, lower), 0)))


def within_lattice(rows, lower, upper):
    """The upper end of the largest box inside the lattice that has the same lower end as a box, and
    lies in it. The rows of the lattice, with `rows` cells, never become longer."""
    widths = np.minimum(rows[lower[1]:upper[1]], upper[2]) - lower[2]
    areas = np.arange(1, len(widths) + 1) * np.maximum(widths, 0)
    if not areas.size or not areas.max():
        return lower
    best = int(np.argmax(areas))
    return upper[0], lower[1] + best + 1, lower[2] + int(widths[best])


def boundary(finite, lattice):
    """The indices of cells of the lattice without a value that adjoin one with a value."""
    near = np.zeros_like(finite)
    for axis in range(finite.ndim):
        to, of = ([slice(None)] * finite.ndim for _ in range(2))
        to[axis], of[axis] = slice(1, None), slice(None, -1)
        near[tuple(to)] |= finite[tuple(of)]
        near[tuple(of)] |= finite[tuple(to)]
    return np.argwhere(near & lattice & ~finite)


def pivot(finite, holes, lower, upper):
    """The cell without a value nearest to the middle of a box, or None in a full box."""
    inside = holes[((holes >= lower) & (holes < upper)).all(axis=1)]
    if not len(inside):  # a box with and without values has a boundary between them
        return None if finite[lower] else lower
    distance = np.abs((inside + 0.5 - lower) / np.subtract(upper, lower) - 0.5).max(axis=1)
    return tuple(int(i) for i in inside[np.argmin(distance)])


def parts(lower, upper, cell):
    """The largest boxes in a box that lack one of its cells: two for each axis."""
    for axis in range(len(lower)):
        yield lower, (*upper[:axis], cell[axis], *upper[axis + 1:])
        yield (*lower[:axis], cell[axis] + 1, *lower[axis + 1:]), upper


def largest_full_box(finite, rows):
    """The largest Box of a lattice in which all cells have a value, or None if none has one.

    finite  whether each cell has a value, an array (r1, r3, r2)
    rows    the number of cells along r2 for each r3; never increasing

    Branch and bound, largest bound first. The bound of a box is the largest box inside the lattice
    that it contains. If a cell of that one lacks a value, a full box lies on one of its six sides.
    The first bound that is a full box is the largest. After MOST_STEPS, the search descends along
    the largest bounds instead, and the box found need not be the largest.
    """
    lattice = np.broadcast_to(rows[:, np.newaxis] > np.arange(finite.shape[2]), finite.shape)
    finite = finite & lattice
    if not finite.any():
        return None
    holes = boundary(finite, lattice)
    first, end = (0, 0, 0), finite.shape
    queue = [(-cells(first, within_lattice(rows, first, end)), first, end)]
    seen, steps, most = set(), 0, None
    while True:
        if steps == MOST_STEPS:
            most = -min(queue)[0]
            queue.sort(reverse=True)  # from here on a stack
        steps += 1
        _, lower, upper = queue.pop() if most else heapq.heappop(queue)
        inner = within_lattice(rows, lower, upper)
        cell = pivot(finite, holes, lower, inner)
        if cell is None:
            return Box(lower, inner, most or cells(lower, inner))
        sides = [(-cells(part[0], within_lattice(rows, *part)), *part)
                 for part in parts(lower, upper, cell) if cells(*part) and part not in seen]
        for side in sorted((side for side in sides if side[0] < 0), reverse=True):
            seen.add(side[1:])
            if most:
                queue.append(side)
            else:
                heapq.heappush(queue, side)
