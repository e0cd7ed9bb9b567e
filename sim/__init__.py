"""Robots and worlds: the simulator, and recordings that play the part of a robot."""
