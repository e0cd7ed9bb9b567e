"""Echoes that no line has claimed yet: they wait until enough of them have come together to be searched once more.

A wall in a niche is heard a few times each time that the robot passes: no batch has enough of its echoes, several batches have.
"""

from dataclasses import dataclass, field

import numpy as np

from knowledge_sources.echoes import Echoes, Index, no_echoes


@dataclass(frozen=True, slots=True, eq=False)
class Leftovers:
    """What waits: echoes, oldest first, the batch that each came in, and how many came since the last search."""

    echoes: Echoes = field(default_factory=no_echoes)
    batches: Index = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    new: int = 0

    def with_more(self, echoes: Echoes, batch: int, at_most: int) -> "Leftovers":
        """Return these and more of a batch, the oldest forgotten beyond `at_most`."""
        joined = self.echoes.join(echoes)
        batches = np.concatenate([self.batches, np.full(len(echoes), batch, dtype=np.intp)])
        kept = np.arange(max(0, len(joined) - at_most), len(joined))
        return Leftovers(joined.take(kept), batches[kept], self.new + len(echoes))

    def after_search(self, claimed: Index) -> "Leftovers":
        """Return what is left when lines have claimed these."""
        free = np.ones(len(self.echoes), dtype=bool)
        free[claimed] = False
        return Leftovers(self.echoes.take(free), self.batches[free], 0)
