"""The one allocator of names: the wanted name, else with `_` appended until it is free."""
from __future__ import annotations

import builtins
import keyword
from collections.abc import Iterable


class Names:
    """Names taken in one function; the user's are taken from the start and never change.

    >>> names = Names(["u", "u_bar"])
    >>> names.fresh("u_bar"), names.fresh("v_bar"), names.fresh("u_bar")
    ('u_bar_', 'v_bar', 'u_bar__')
    """

    def __init__(self, taken: Iterable[str] = ()):
        self.taken = set(taken)

    def fresh(self, wanted: str) -> str:
        while wanted in self.taken or keyword.iskeyword(wanted) or hasattr(builtins, wanted):
            wanted += "_"
        self.taken.add(wanted)
        return wanted
