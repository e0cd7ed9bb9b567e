"""Pose and lines in one estimate: what is learned of one moves the others (the stochastic map)."""
