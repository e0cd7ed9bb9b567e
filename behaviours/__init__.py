"""Behaviours, their coordination, and the safety layer below them."""
