"""Keys of the link's own machinery. Chunks that begin with '@' are verbatim: `ski/**` does not match them."""


def entries(robot: str, panel: str = "") -> str:
    """Return the expression of all entries of a robot's board, or of one panel."""
    return f"ski/{robot}/{panel}/**" if panel else f"ski/{robot}/**"


def keeper(robot: str, what: str) -> str:
    """Return the keeper's key for a robot's board: beat, clock, lost, snapshot."""
    return f"ski/{robot}/@keeper/{what}"


def late(robot: str, panel: str) -> str:
    """Return the key under which a poster hands in what the keeper has not got."""
    return f"ski/{robot}/@late/{panel}"


def host_beat(robot: str, host: str) -> str:
    """Return the key of a host's heartbeat."""
    return f"ski/{robot}/@hosts/{host}/beat"


def host_alive(robot: str, host: str, boot: str) -> str:
    """Return the key of a host's liveliness token."""
    return f"ski/{robot}/@hosts/{host}/alive/{boot}"


KEEPER_STATUS = "ski/@keeper/status"
