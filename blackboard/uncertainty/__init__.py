"""How sure one may be: one module for each theory of Bou-Ghannam 1992, section 2.5, as pure functions.

`normal_distance` and `kalman` for parameters with a covariance; `bayes`, `certainty`, `fuzzy` and `dempster_shafer` for hypotheses
with numbers; `endorsements` for hypotheses with reasons. Nothing here knows a board or a clock.
"""
