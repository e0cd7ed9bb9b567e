"""Every story that is shipped is as told, on either engine."""

from pathlib import Path

import pytest

from rules.command.test import shipped_stories
from rules.storytelling.telling import tell


@pytest.mark.parametrize("engine", ["experta", "clips"])
@pytest.mark.parametrize("path", shipped_stories(), ids=lambda path: path.stem)
def test_as_told(path: Path, engine: str) -> None:
    if engine == "clips":
        pytest.importorskip("clips")
    outcome = tell(path, engine)
    assert outcome.failures == ()
    assert len(outcome.played) == len(outcome.story.steps)
