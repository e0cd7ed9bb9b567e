"""Findings about the way to the keeper, and about the keeper itself."""

from collections.abc import Iterator

from blackboard.watching.finding import DoctorParams, Finding, many
from blackboard.watching.setup_facts import SetupFacts


def link_findings(facts: SetupFacts) -> Iterator[Finding]:
    """Yield why the keeper is not reached, where it is not."""
    address, said = facts.address, f" ({facts.trouble})" if facts.trouble else ""
    if facts.answers == "nobody":
        yield Finding(
            about="nothing running",
            what=f"nothing listens at {address}{said}",
            do="start all with `ski up MISSION`, or a keeper with `ski board serve`; if it runs elsewhere, --connect ADDRESS",
        )
    elif facts.answers == "something else":
        yield Finding(
            about="wrong port",
            what=f"what listens at {address} is no board keeper and speaks no zenoh{said}",
            do="choose another port for the keeper (`ski board serve --listen ADDRESS`) and name it with --connect ADDRESS",
        )
    elif facts.answers == "certificates":
        yield Finding(
            about="certificate",
            what=f"the keeper at {address} takes members with certificates only{said}",
            do="name the folder of your keys with --keys DIR (or SKI_KEYS); `ski keys add` makes them where the keeper's were made",
        )
    elif facts.answers == "refused":
        yield Finding(
            about="certificate",
            what=f"the keeper at {address} and these keys do not accept each other{said}",
            do="take good keys of this keeper's own authority, and an address that its certificate names: `ski keys`",
        )
    elif facts.answers == "no certificates":
        yield Finding(
            about="certificate",
            what=f"the keeper at {address} takes no certificates, and --keys shows some{said}",
            do="leave --keys (and SKI_KEYS) out, or start the keeper with its keys: `ski board serve --keys DIR`",
        )
    elif facts.answers == "a router" and facts.member:
        yield Finding(
            about="certificate",
            what=f"what listens at {address} lets {facts.member} in and answers nothing",
            do="see with `ski keys list` whether these keys were withdrawn; else no keeper is there: `ski board serve --keys DIR`",
        )
    elif facts.answers == "a router" or facts.keeper is None:
        yield Finding(
            about="no keeper",
            what=f"a zenoh router listens at {address}, and no board keeper answers there{said}",
            do="stop that router or leave it its port, and start `ski board serve`",
        )


def keeper_findings(facts: SetupFacts, params: DoctorParams) -> Iterator[Finding]:
    """Yield what the keeper says of itself that is not as it should be."""
    keeper = facts.keeper
    assert keeper is not None
    if keeper.version and keeper.version != facts.version:
        yield Finding(
            about="version difference",
            what=f"the keeper is ski {keeper.version}, this is ski {facts.version}",
            do="install one version everywhere and start what is older anew",
        )
    if keeper.journal_trouble:
        yield Finding(
            about="journal",
            what=f"the keeper cannot write its journal in {keeper.folder or 'its folder'}: {keeper.journal_trouble}",
            do="free some space there: it goes on by itself, and the hosts keep what it has not got until then",
        )
    for reason, count in sorted(keeper.refused.items()):
        example = keeper.refused_example.get(reason, "")
        yield Finding(
            about="rejected writer",
            what=f"the keeper refused {many(count, 'post')} ({reason})" + (f", the last: {example}" if example else ""),
            do="mend or stop who posts it; refused.jsonl in the keeper's folder names every one",
        )
    for attempt, count in sorted(keeper.rejected.items()):
        yield Finding(
            about="rejected writer",
            what=f"the keeper turned away {many(count, 'message')} that its sender's role does not allow ({attempt})",
            do="give the sender keys with the role that it needs: `ski keys`; or find out who tries",
        )
    if keeper.overflowed:
        yield Finding(
            about="slow reader",
            what=f"the keeper could not keep up and dropped {many(keeper.overflowed, 'message')}, which are sent again",
            do="give its machine less to do, or post less: `ski watch --sort rate` shows who posts most",
        )
