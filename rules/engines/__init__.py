"""Engines that run rule programs: experta by default, CLIPS itself where it is installed."""
