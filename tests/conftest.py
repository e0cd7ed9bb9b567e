"""Hypothesis settings for all tests: the same examples in each run; `--hypothesis-profile=search` looks at many others."""

from hypothesis import settings

settings.register_profile("steady", derandomize=True, database=None, deadline=None, print_blob=True)
settings.register_profile("search", derandomize=False, deadline=None, max_examples=1000)
settings.load_profile("steady")
