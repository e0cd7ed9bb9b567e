"""What a motivation asks of a behaviour, as numbers."""

from blackboard.errors import MissionError


def numbers(
    behaviour: str, names: tuple[str, ...], parameters: tuple[float | str, ...], optional: int = 0
) -> tuple[float, ...]:
    """Return a motivation's parameters as numbers; raise MissionError where they are not those that the behaviour names."""
    wanted = f"{behaviour} takes ({', '.join(names)}), numbers" + (
        f", the last {optional} optional" if optional else ""
    )
    if not len(names) - optional <= len(parameters) <= len(names):
        raise MissionError(f"{wanted}; it was given {len(parameters)}")
    for name, value in zip(names, parameters, strict=False):
        if isinstance(value, str):
            raise MissionError(f"{wanted}; {name} = {value!r} is no number")
    return tuple(float(value) for value in parameters)
