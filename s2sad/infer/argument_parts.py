"""argument_parts: what an integer of an argument is that conditions on calls are about."""
from __future__ import annotations

LEAST, GREATEST = "least", "greatest"       # element of an array of integers
Part = int | str | None                     # the size of an axis, one of these two, or an integer itself

__all__ = ["GREATEST", "LEAST", "Part"]
