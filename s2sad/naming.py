"""The one allocator of names: the requested name; with `_` appended where a user's name is in the way, numbered where
one of ours is."""
from __future__ import annotations

import builtins
import keyword
import re
from collections.abc import Iterable


def identifier(wanted: str) -> str:
    """An identifier for what a user calls something, a key of a dictionary too.

    >>> identifier("hops_(0, 1)"), identifier("0"), identifier("class")
    ('hops_0_1', 'value_0', 'value_class')
    """
    found = wanted if wanted.isidentifier() else re.sub(r"[\W_]+", "_", wanted).strip("_") or "value"
    return f"value_{found}" if found[0].isdigit() or keyword.iskeyword(found) else found


class Names:
    """Names taken in one function; the user's are taken from the start and never change.

    `hints` has the requested name of every name that was made, `user_names` what a user calls some of them.

    >>> names = Names(["u", "u_bar"])
    >>> names.fresh("u_bar"), names.fresh("v_bar"), names.fresh("u_bar"), names.fresh("v_bar")
    ('u_bar_', 'v_bar', 'u_bar__2', 'v_bar_2')
    """

    def __init__(self, taken: Iterable[str] = ()):
        self.taken = set(taken)
        self.hints: dict[str, str] = {}
        self.user_names: dict[str, str] = {}
        self._numbers: dict[str, int] = {}      # for each hint a number below which none is free

    def copy(self) -> Names:
        """The same names, for a function of which another version is made."""
        new = Names(self.taken)
        new.hints, new.user_names = dict(self.hints), dict(self.user_names)
        return new

    def numbered(self, hint: str) -> str:
        """A new name: the requested one, else numbered from 2."""
        return self.fresh(self._free(hint))

    def release(self, *names: str) -> None:
        """Names that were made and are not used after all."""
        self.taken -= {*names}
        self._numbers.clear()

    def _free(self, hint: str) -> str:
        """The requested name, or the first of its numbered ones that is not taken."""
        number = self._numbers.get(hint, 1)
        made = hint if number == 1 else f"{hint}_{number}"
        while made in self.taken:
            number += 1
            made = f"{hint}_{number}"
        self._numbers[hint] = number
        return made

    def fresh(self, hint: str) -> str:
        made = hint
        while made in self.taken and made not in self.hints or keyword.iskeyword(made) or hasattr(builtins, made):
            made += "_"
        made = self._free(made)
        self.taken.add(made)
        self.hints[made] = hint
        return made

    def user_name(self, identifier: str) -> str:
        """The name in messages: what the user calls it."""
        return self.user_names.get(identifier, identifier)
