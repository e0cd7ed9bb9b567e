"""The vocabulary: every message type, by topic. Units stand in the field names, limits in the annotations."""
