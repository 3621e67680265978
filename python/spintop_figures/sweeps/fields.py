"""Fields over a grid: where they jump, where they are zero, and where a class has its name."""

from typing import NamedTuple

import numpy as np

COARSE = 60
"""Cells of a grid along an axis by which the place of a name is found; finer ones are skipped."""


class Spot(NamedTuple):
    """The middle of a region of one class, as shares of the grid, and how much room is there."""

    code: int
    x: float
    y: float
    width: float
    height: float


def jumps(cells: np.ndarray) -> tuple[np.ndarray, float]:
    """Which cells are beside a jump, and how large the jumps are; nan without one.

    A jump is a change of sign between neighbours along an axis that is much larger than the
    changes before and after it: a branch cut, such as that of an angle that grows by a turn.
    """
    beside = np.zeros(cells.shape, dtype=bool)
    sizes: list[float] = []
    values = np.ma.filled(cells, np.nan)
    for axis in (0, 1):
        rows, marks = np.moveaxis(values, axis, 0), np.moveaxis(beside, axis, 0)
        change = np.abs(np.diff(rows, axis=0))
        quiet = np.zeros_like(change)
        quiet[1:] = np.fmax(quiet[1:], change[:-1])
        quiet[:-1] = np.fmax(quiet[:-1], change[1:])
        crosses = rows[1:] * rows[:-1] < 0
        # much larger than those on either side
        is_jump = crosses & (change > 4.0 * quiet) & (len(change) > 1)
        marks[1:] |= is_jump
        marks[:-1] |= is_jump
        sizes += change[is_jump].tolist()
    return beside, float(np.median(sizes)) if sizes else float("nan")


def regions(codes: np.ndarray) -> list[np.ndarray]:
    """The connected regions of cells with the same code, the largest first; nan belongs to none."""
    left = np.isfinite(codes)
    found = []
    while left.any():
        seed = np.unravel_index(np.argmax(left), left.shape)
        same = left & (codes == codes[seed])
        region = np.zeros_like(left)
        region[seed] = True
        size = 0
        while size != (size := int(region.sum())):
            for axis in (0, 1):
                for step in (1, -1):
                    moved = np.roll(region, step, axis)
                    edge = [slice(None)] * 2
                    edge[axis] = 0 if step == 1 else -1
                    moved[tuple(edge)] = False
                    region |= moved & same
        found.append(region)
        left &= ~region
    return sorted(found, key=lambda region: -int(region.sum()))


def spots(codes: np.ndarray) -> list[Spot]:
    """Where the regions of a field of classes have room for a name.

    The room is that of the largest rectangle, of cells, about the cell that is furthest inside.
    """
    strides = [max(1, size // COARSE) for size in codes.shape]
    coarse = codes[:: strides[0], :: strides[1]]
    down, across = coarse.shape
    found = []
    for region in regions(coarse):
        if region.sum() < 0.02 * region.size:  # too small for a name
            break
        depth, inside = 0, region
        while inside.any():
            depth, deepest = depth + 1, inside
            padded = np.pad(inside, 1, mode="edge" if depth == 1 else "constant")
            inside = (
                inside & padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:]
            )
        lines, columns = np.nonzero(deepest)
        middle = np.argmin((lines - lines.mean()) ** 2 + (columns - columns.mean()) ** 2)
        y, x = int(lines[middle]), int(columns[middle])
        left, right = reach(region[y], x)
        low, high = reach(region[:, x], y)
        found.append(
            Spot(
                int(coarse[y, x]),
                (left + right + 1) / 2 / across,
                (y + 0.5) / down,
                (right - left + 1) / across,
                (high - low + 1) / down,
            )
        )
    return found


def reach(line: np.ndarray, place: int) -> tuple[int, int]:
    """The first and the last cell of the run of true ones about a place."""
    before, after = np.flatnonzero(~line[:place]), np.flatnonzero(~line[place:])
    first = int(before[-1]) + 1 if before.size else 0
    last = place + int(after[0]) - 1 if after.size else line.size - 1
    return first, last
