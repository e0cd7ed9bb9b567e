"""Holding the robot's pose by matching its newest sonar echoes to a grid of the older ones."""
