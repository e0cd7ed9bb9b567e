"""A robot's sensors by the numbers that its scans give them."""

from blackboard.errors import BoardError
from blackboard.messages.sensing import CameraSensor, LaserSensor, RobotDescription, SonarSensor


def sonar_of(robot: RobotDescription, number: int) -> SonarSensor:
    """Return a sonar; raise BoardError where the description of the robot has none of that number."""
    if number >= len(robot.sonars):
        raise BoardError(_missing(robot, "sonar", number, len(robot.sonars)))
    return robot.sonars[number]


def laser_of(robot: RobotDescription, number: int) -> LaserSensor:
    """Return a laser; raise BoardError where the description of the robot has none of that number."""
    if number >= len(robot.lasers):
        raise BoardError(_missing(robot, "laser", number, len(robot.lasers)))
    return robot.lasers[number]


def camera_of(robot: RobotDescription, number: int) -> CameraSensor:
    """Return a camera; raise BoardError where the description of the robot has none of that number."""
    if number >= len(robot.cameras):
        raise BoardError(_missing(robot, "camera", number, len(robot.cameras)))
    return robot.cameras[number]


def _missing(robot: RobotDescription, what: str, number: int, count: int) -> str:
    has = f"numbers 0 to {count - 1}" if count else "none"
    return f"a scan names {what} number {number}, the description of robot '{robot.name}' has {has}; add it to status/robot"
