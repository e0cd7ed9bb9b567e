"""Names of places that are found again."""

from knowledge_sources.standing_hypotheses import Names


def test_the_nearest_keeps_its_name() -> None:
    names = Names("target", 0.5)
    assert names.name([(0.0, 0.0), (2.0, 0.0)]) == ["target-1", "target-2"]
    assert names.name([(2.1, 0.0), (0.3, 0.0), (0.1, 0.0)]) == ["target-2", "target-3", "target-1"]
    assert names.name([(9.0, 0.0)]) == ["target-4"]
    assert names.name([(0.1, 0.0)]) == ["target-5"]  # once given up, a name does not come back
    assert names.name([]) == []
