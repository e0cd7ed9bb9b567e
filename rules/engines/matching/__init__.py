"""Facts matched against conditions: a Rete network with hash-indexed joins and CLIPS's semantics, under experta's engine."""
