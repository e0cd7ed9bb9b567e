"""What no line claimed waits, bounded, until it is searched."""

import numpy as np

from knowledge_sources.echoes import Echoes, in_order
from knowledge_sources.leftover_echoes import Leftovers


def echoes(*x_m: float) -> Echoes:
    here = np.array([(x, 0.0) for x in x_m]).reshape(-1, 2)
    return in_order(here, here + 1.0, np.zeros(len(here)), 0.5, 1.4)


def test_the_oldest_are_forgotten() -> None:
    kept = Leftovers().with_more(echoes(1.0, 2.0, 3.0), 7, 4).with_more(echoes(4.0, 5.0), 8, 4)
    assert kept.echoes.x_m.tolist() == [2.0, 3.0, 4.0, 5.0]
    assert kept.batches.tolist() == [7, 7, 8, 8]
    assert kept.new == 5


def test_what_a_search_claims_is_gone_and_the_rest_waits_on() -> None:
    kept = Leftovers().with_more(echoes(1.0, 2.0, 3.0), 7, 4).after_search(np.array([1]))
    assert kept.echoes.x_m.tolist() == [1.0, 3.0]
    assert kept.batches.tolist() == [7, 7]
    assert kept.new == 0


def test_none_may_be_kept() -> None:
    assert len(Leftovers().with_more(echoes(1.0), 1, 0).echoes) == 0
