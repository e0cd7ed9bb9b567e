"""The board: what every component of `ski` shares, and what composes them.

`blackboard` owns the vocabulary (messages and kinds), the board itself, the control of knowledge sources, missions, and
the command line. It imports none of the packages that stand on it.
"""
