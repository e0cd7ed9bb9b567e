"""Explains rules to those who write them: why one did not fire, and which fired at all."""
