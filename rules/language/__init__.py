"""The rule language: the part of CLIPS that rule files may use, read with positions, checked, and evaluated."""
