"""Places by the square that they lie in, so that those near a line are found without asking all of a large map."""

import numpy as np

from knowledge_sources.echoes import Array, Index


class Buckets:
    """Places (n,), in squares of `side_m`."""

    def __init__(self, x_m: Array, y_m: Array, side_m: float) -> None:
        self._side_m = side_m
        self._left_m, self._bottom_m = (float(v.min()) if len(v) else 0.0 for v in (x_m, y_m))
        column, row = self._square(x_m, y_m)
        self._width = int(column.max(initial=0)) + 3  # a column more on either side: rows do not touch
        square = (row + 1) * self._width + column + 1
        self._order = np.argsort(square, kind="stable")
        self._squares = square[self._order]

    def along(self, x0_m: float, y0_m: float, x1_m: float, y1_m: float) -> Index:
        """Return, in their order, all places within half a side of the segment, and some beyond."""
        count = int(np.hypot(x1_m - x0_m, y1_m - y0_m) / self._side_m) + 2
        columns, rows = self._square(np.linspace(x0_m, x1_m, count), np.linspace(y0_m, y1_m, count))
        inside = (columns >= -1) & (columns <= self._width - 2)
        around = (rows[inside] + 1) * self._width + columns[inside] + 1
        steps = np.array([i * self._width + j for i in (-1, 0, 1) for j in (-1, 0, 1)])
        squares = np.unique(around[:, None] + steps)
        first, last = (np.searchsorted(self._squares, squares, side=side) for side in ("left", "right"))
        parts = [self._order[a:b] for a, b in zip(first.tolist(), last.tolist(), strict=True) if b > a]
        return np.sort(np.concatenate(parts)) if parts else np.zeros(0, dtype=np.intp)

    def _square(self, x_m: Array, y_m: Array) -> tuple[Index, Index]:
        column = np.floor((x_m - self._left_m) / self._side_m).astype(np.intp)
        return column, np.floor((y_m - self._bottom_m) / self._side_m).astype(np.intp)
