"""All functions that expressions may call, by name; `and` and `or`, which stop early, are part of the evaluation itself."""

from rules.language.library.arithmetic import ARITHMETIC
from rules.language.library.comparison import COMPARISON
from rules.language.library.function import FunctionFault, LibraryFunction, printed
from rules.language.library.multifields import MULTIFIELDS
from rules.language.library.text import TEXT
from rules.language.library.trigonometry import TRIGONOMETRY

__all__ = ["FUNCTIONS", "STOP_EARLY", "FunctionFault", "LibraryFunction", "printed"]

FUNCTIONS: dict[str, LibraryFunction] = ARITHMETIC | COMPARISON | TRIGONOMETRY | TEXT | MULTIFIELDS
STOP_EARLY = {"and": (2, None), "or": (2, None)}
