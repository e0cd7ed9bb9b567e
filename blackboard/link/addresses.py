"""Keys of the link's own machinery. Chunks that begin with '@' are verbatim: `ski/**` does not match them."""


def entries(robot: str, panel: str = "") -> str:
    """Return the expression of all entries of a robot's board, or of one panel."""
    return f"ski/{robot}/{panel}/**" if panel else f"ski/{robot}/**"


def keeper(robot: str, what: str) -> str:
    """Return the keeper's key for a robot's board: beat, begin, clock, lost, snapshot."""
    return f"ski/{robot}/@keeper/{what}"


def late(robot: str, place: str) -> str:
    """Return the key under which a poster hands in what the keeper has not got.

    `place` is what follows the robot in an entry's key, two chunks of it: who may post there may hand in there.
    """
    return f"ski/{robot}/@late/{place}"


def place_of(key: str) -> str:
    """Return the place that an entry's key belongs to: panel and level, or panel and kind."""
    return "/".join(key.split("/")[2:4])


def host_beat(robot: str, host: str) -> str:
    """Return the key of a host's heartbeat."""
    return f"ski/{robot}/@hosts/{host}/beat"


def host_alive(robot: str, host: str, boot: str) -> str:
    """Return the key of a host's liveliness token."""
    return f"ski/{robot}/@hosts/{host}/alive/{boot}"


KEEPER_STATUS = "ski/@keeper/status"
