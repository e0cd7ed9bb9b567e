"""The folder of keys: what is written, who may read it, renewing, revoking, and what is refused."""

import datetime
import json
import stat
from pathlib import Path

import pytest
from cryptography import x509

from blackboard.command.main import main
from blackboard.errors import KeysError, LinkError
from blackboard.keys import folder
from blackboard.keys.certificates import Pair, expiry, hosts_of, make_member
from blackboard.keys.material import keeper_material, member_material
from blackboard.keys.members import read_member, read_members
from blackboard.link.configuration import client_configuration, router_configuration

NOW = datetime.datetime(2030, 5, 1, 12, tzinfo=datetime.UTC)


@pytest.fixture
def keys(tmp_path: Path) -> Path:
    folder.create(tmp_path / "keys", ["robot.lan", "10.0.0.7", "fe80::7"], NOW)
    return tmp_path / "keys"


def certificate(path: Path) -> x509.Certificate:
    return x509.load_pem_x509_certificate(path.read_bytes())


def test_only_the_owner_reads_what_is_written(keys):
    folder.add(keys, ["viewer"], "eve", NOW)
    for path in [keys, *keys.rglob("*")]:
        assert stat.S_IMODE(path.stat().st_mode) == (0o700 if path.is_dir() else 0o600), path
    assert sorted(path.name for path in (keys / "members" / "eve").iterdir()) == [
        "ca.pem",
        "cert.pem",
        "key.pem",
        "member.json",
    ]


def test_certificates_say_who_and_for_what(keys):
    where = folder.add(keys, ["viewer"], "eve", NOW, days=10)
    shown = certificate(where / "cert.pem")
    assert shown.subject.rfc4514_string() == "CN=eve.1"
    assert shown.not_valid_after_utc == NOW + datetime.timedelta(days=10) == read_member(where).expires
    assert shown.not_valid_before_utc < NOW
    shown.verify_directly_issued_by(certificate(where / "ca.pem"))
    uses = shown.extensions.get_extension_for_class(x509.ExtendedKeyUsage).value
    assert list(uses) == [x509.ExtendedKeyUsageOID.CLIENT_AUTH]
    keeper = (keys / "keeper" / "cert.pem").read_bytes()
    assert hosts_of(keeper) == ("robot.lan", "10.0.0.7", "fe80::7", "localhost", "127.0.0.1", "::1")
    uses = certificate(keys / "keeper" / "cert.pem").extensions.get_extension_for_class(x509.ExtendedKeyUsage).value
    assert list(uses) == [x509.ExtendedKeyUsageOID.SERVER_AUTH]


def test_renewing_counts_up_and_revoking_ends(keys):
    folder.add(keys, ["robot"], "r", NOW, robots=["k2a"])
    where = folder.renew(keys, "r", NOW)
    assert certificate(where / "cert.pem").subject.rfc4514_string() == "CN=r.2"
    folder.revoke(keys, "r")
    assert read_members(keys)["r"].revoked
    with pytest.raises(KeysError, match="r was revoked; `ski keys add` it again"):
        folder.renew(keys, "r", NOW)
    folder.add(keys, ["viewer"], "r", NOW)
    again = read_members(keys)["r"]
    assert (again.roles, again.robots, again.generation, again.revoked) == (("viewer",), (), 3, False)


def test_the_keepers_certificate_is_renewed_for_the_same_hosts(keys):
    before = (keys / "keeper" / "cert.pem").read_bytes()
    later = NOW + datetime.timedelta(days=300)
    folder.renew(keys, "keeper", later)
    after = (keys / "keeper" / "cert.pem").read_bytes()
    assert hosts_of(after) == hosts_of(before)
    assert expiry(after) == later + datetime.timedelta(days=folder.DAYS)


def test_nothing_outlives_the_authority(keys):
    late = NOW + datetime.timedelta(days=folder.AUTHORITY_DAYS - 5)
    where = folder.add(keys, ["viewer"], "eve", late)
    assert read_member(where).expires == expiry((keys / "authority" / "ca.pem").read_bytes())
    with pytest.raises(KeysError, match="the authority has expired"):
        folder.add(keys, ["viewer"], "adam", NOW + datetime.timedelta(days=folder.AUTHORITY_DAYS))


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["init", "{keys}", "--host", "h"], "is not empty; name another folder"),
        (
            ["init", "{keys}/new", "--host", "h:7447"],
            "host 'h:7447': give a host name or an IP address, without a port",
        ),
        (["init", "{keys}/new", "--host", "0.0.0.0"], "is no place that others can reach"),
        (["init", "{keys}/members.json/x", "--host", "h"], "cannot be made"),
        (["init", "{keys}/new", "--host", "h", "--days", "0"], "--days 0 is outside 1..3650"),
        (["add", "{keys}", "viewr", "eve"], "there is no role 'viewr'; did you mean 'viewer'"),
        (["add", "{keys}", "viewer", "../eve"], "name '../eve': use letters"),
        (["add", "{keys}", "viewer", "keeper"], "'keeper' is the keeper's own name"),
        (["add", "{keys}", "robot", "r"], "add `--robot NAME`"),
        (["add", "{keys}/authority", "viewer", "eve"], "holds no keeper's keys; make them: `ski keys init"),
        (["renew", "{keys}", "eve"], "there is no member 'eve'; members: nobody yet"),
        (["revoke", "{keys}", "eve"], "there is no member 'eve'"),
        (["list", "{keys}/nowhere"], "holds no keeper's keys"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(keys, capsys, arguments, says):
    before = sorted(keys.rglob("*"))
    assert main(["keys", *(word.format(keys=keys) for word in arguments)]) == 2
    said = capsys.readouterr().err
    assert says in said
    assert said.startswith("ski: ")
    assert said.count("\n") == 1
    assert sorted(keys.rglob("*")) == before


def test_a_member_is_not_added_twice(keys):
    folder.add(keys, ["viewer"], "eve", NOW)
    with pytest.raises(KeysError, match="eve is a member already"):
        folder.add(keys, ["operator"], "eve", NOW)


def test_the_listing_shows_what_expires(tmp_path, capsys):
    keys = str(tmp_path / "keys")
    assert main(["keys", "init", keys, "--host", "robot.lan"]) == 0
    for arguments in (["viewer", "eve", "--days", "9"], ["agent,knowledge", "barn", "--hosts", "a", "b"]):
        assert main(["keys", "add", keys, *arguments]) == 0
    assert main(["keys", "revoke", keys, "barn"]) == 0
    capsys.readouterr()
    assert main(["keys", "list", keys, "--json"]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)}
    assert {name: row["state"] for name, row in rows.items()} == {
        "keeper": "good",
        "eve": "expires in 8 days",
        "barn": "revoked",
    }
    assert rows["barn"]["hosts"] == ["a", "b"]
    assert main(["keys", "list", keys]) == 0
    assert "robot.lan,localhost,127.0.0.1,::1" in capsys.readouterr().out


@pytest.mark.parametrize(
    "text", ["", "[", "{}", "[1]", '[{"name": "../x", "roles": ["viewer"], "expires": "2030-01-01T00:00:00Z"}]']
)
def test_a_spoiled_list_of_members_starts_no_keeper(keys, text):
    (keys / "members.json").write_text(text)
    with pytest.raises(KeysError, match=r"members\.json"):
        router_configuration("0.0.0.0", keys)


def test_keys_are_looked_at_before_zenoh_does(keys):
    where = folder.add(keys, ["viewer"], "eve", NOW)
    member_material(where, NOW)
    with pytest.raises(KeysError, match=r"the keys of eve expired on 2031-05-01; `ski keys renew DIR eve`"):
        member_material(where, NOW + datetime.timedelta(days=400))
    with pytest.raises(KeysError, match="holds the keeper's keys; name the folder of a member"):
        member_material(keys, NOW)
    with pytest.raises(KeysError, match="holds no keeper's keys"):
        keeper_material(where, NOW)
    assert [member.name for member in keeper_material(keys, NOW)[1]] == ["eve"]
    with pytest.raises(KeysError, match=r"the keeper's keys expired on 2031-05-01; `ski keys renew .*keys keeper`"):
        keeper_material(keys, NOW + datetime.timedelta(days=400))
    (where / "key.pem").chmod(0o640)
    with pytest.raises(KeysError, match="can be read by others; `chmod 600"):
        member_material(where, NOW)
    (where / "key.pem").unlink()
    with pytest.raises(KeysError, match=r"key\.pem cannot be read"):
        member_material(where, NOW)
    (where / "key.pem").write_bytes(b"")
    with pytest.raises(KeysError, match=r"key\.pem is no PEM file"):
        member_material(where, NOW)


def test_other_zenoh_tools_get_a_configuration(keys, capsys, monkeypatch):
    folder.add(keys, ["viewer"], "eve", datetime.datetime.now(datetime.UTC))
    monkeypatch.chdir(keys / "members")
    assert main(["keys", "config", "eve", "--connect", "robot.lan:7612"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == client_configuration("tls/robot.lan:7612", keys / "members" / "eve")


def test_with_keys_nothing_goes_in_the_clear(keys):
    where = folder.add(keys, ["viewer"], "eve", datetime.datetime.now(datetime.UTC))
    for address in ("tcp/0.0.0.0:7612", "tls/0.0.0.0:7612", "0.0.0.0:7612"):
        router = router_configuration(address, keys)
        client = client_configuration(address, where)
        assert router["listen"]["endpoints"] == client["connect"]["endpoints"] == ["tls/0.0.0.0:7612"]
        for side in (router, client):
            assert side["transport"]["link"]["protocols"] == ["tls"]
            assert side["transport"]["link"]["tls"]["enable_mtls"] is True
            assert side["transport"]["link"]["tls"]["verify_name_on_connect"] is True
        assert router["access_control"]["default_permission"] == "deny"
    with pytest.raises(LinkError, match="address"):
        client_configuration("0.0.0.0:0", where)


def test_a_folder_that_cannot_be_written_is_named(keys):
    (keys / "members").write_text("in the way")
    with pytest.raises(KeysError, match="members cannot be made"):
        folder.add(keys, ["viewer"], "eve", NOW)
    assert read_members(keys) == {}


def test_a_spoiled_authority_is_named(keys):
    good = Pair((keys / "authority" / "ca.pem").read_bytes(), (keys / "authority" / "key.pem").read_bytes())
    with pytest.raises(KeysError, match="the authority's key is spoiled"):
        make_member(Pair(good.certificate, b"x"), "eve.1", NOW, 1)
    with pytest.raises(KeysError, match="this is no certificate"):
        make_member(Pair(b"x", good.key), "eve.1", NOW, 1)
