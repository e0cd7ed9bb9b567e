"""Holding the robot's pose by matching its newest sonar echoes to patches of a grid of the older ones."""
