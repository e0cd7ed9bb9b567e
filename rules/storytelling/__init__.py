"""Stories about rules: facts seen in turn, and what must stand after each step. `ski rules test` tells them to an engine."""
