"""The one place that imports experta.

experta 1.9.4 pins frozendict 1.2, which looks for `collections.Mapping`: gone since Python 3.10, so it stands there while the
import runs and is taken away after it. experta also calls `logging.basicConfig()`, which is undone: logging belongs to the program.
"""

import collections
import logging
import sys
import warnings

_handlers = list(logging.getLogger().handlers)
_borrowed = sys.version_info >= (3, 10) and "experta" not in sys.modules
if _borrowed:
    setattr(collections, "Mapping", collections.abc.Mapping)  # noqa: B010  (mypy knows that it is not there)
try:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        from experta import Fact, KnowledgeEngine, Rule
        from experta.abstract import Matcher, Strategy
        from experta.activation import Activation
        from experta.factlist import FactList
finally:
    if _borrowed:
        delattr(collections, "Mapping")
    for _handler in list(logging.getLogger().handlers):
        if _handler not in _handlers:
            logging.getLogger().removeHandler(_handler)

__all__ = ["Activation", "Fact", "FactList", "KnowledgeEngine", "Matcher", "Rule", "Strategy"]
