"""`ski doctor` and `ski post` where a keeper takes certificates, and where one does not."""

import datetime
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Thread

import pytest

from blackboard.command.main import main
from blackboard.keeper.service import Keeper
from blackboard.keys import folder
from blackboard.link.session import LinkParams
from blackboard.vocabulary import Vocabulary

NAV = "ski/k2a/motivations/motivation/target_nav"
NOW = datetime.datetime.now(datetime.UTC)


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("keys") / "keys"
    folder.create(path, ["board.lan"], NOW)
    folder.add(path, ["viewer"], "eve", NOW)
    folder.add(path, ["operator"], "olga", NOW)
    folder.add(path, ["viewer"], "gone", NOW)
    folder.revoke(path, "gone")
    folder.add(path, ["viewer"], "old", NOW - datetime.timedelta(days=5), days=1)
    foreign = path.with_name("foreign")
    folder.create(foreign, ["board.lan"], NOW)
    folder.add(foreign, ["operator"], "olga", NOW)
    return path


@pytest.fixture
def locked(keys: Path, address: str, tmp_path: Path) -> Iterator[str]:
    """The address of a keeper that takes certificates."""
    keeper = Keeper(LinkParams(address=address, keys=keys), tmp_path / "locked", Vocabulary())
    thread = Thread(target=keeper.run)
    try:
        keeper.open()
        thread.start()
        yield address
    finally:
        keeper.stop()
        if thread.is_alive():
            thread.join()
        keeper.close()


@pytest.fixture
def doctor(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[str, str]]:
    """Return a function that gives the one finding: what it is about, and what it is."""

    def ask(address: str, keys: Path | None = None) -> tuple[str, str]:
        shown = ["--keys", str(keys)] if keys is not None else []
        assert main(["doctor", "--json", "--for", "0.3", "--connect", address, *shown]) == 1
        (found,) = json.loads(capsys.readouterr().out)
        return found["about"], found["what"]

    return ask


def test_the_keeper_wants_certificates(locked: str, doctor: Callable[..., tuple[str, str]], keys: Path) -> None:
    assert doctor(locked) == ("certificate", f"the keeper at {locked} takes members with certificates only")
    assert doctor(locked, keys / "members" / "eve")[0] == "no hosts"  # all is well with the link
    about, what = doctor(locked, keys.with_name("foreign") / "members" / "olga")
    assert (about, "do not accept each other (certificate verify failed)" in what) == ("certificate", True)
    about, what = doctor(locked, keys / "members" / "gone")
    assert (about, "lets gone (viewer) in and answers nothing" in what) == ("certificate", True)
    about, what = doctor(locked, keys / "members" / "old")
    assert (about, "the keys of old expired on" in what) == ("certificate", True)
    about, what = doctor(locked, keys / "nothing")
    assert (about, "holds no member's keys" in what) == ("certificate", True)


def test_the_keeper_wants_none(
    keeper: Keeper, address: str, doctor: Callable[..., tuple[str, str]], keys: Path
) -> None:
    about, what = doctor(address, keys / "members" / "eve")
    assert (about, "takes no certificates" in what) == ("certificate", True)


def test_who_may_post(locked: str, keys: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["post", NAV, '{"on": true}', "--connect", locked, "--keys"]
    assert main([*arguments, str(keys / "members" / "eve")]) == 2
    assert capsys.readouterr().err.startswith(f"ski: {NAV}: eve (viewer) may not post there")
    assert main([*arguments, str(keys / "members" / "olga")]) == 0
    assert capsys.readouterr().out.startswith(f"{NAV} r1 ")
    for verb in (["get", "--json"], ["watch", "--json", "--for", "0.1"]):
        assert main([*verb, "--connect", locked, "--keys", str(keys / "members" / "eve")]) == 0
        assert NAV in capsys.readouterr().out
