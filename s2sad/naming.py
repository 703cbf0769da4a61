"""The one allocator of names: the wanted name; with `_` appended where a user's name is in the way, numbered where
one of ours is."""
from __future__ import annotations

import builtins
import keyword
from collections.abc import Iterable


class Names:
    """Names taken in one function; the user's are taken from the start and never change.

    `wanted` has the requested name of every name that was made, `meant` what a user calls some of them.

    >>> names = Names(["u", "u_bar"])
    >>> names.fresh("u_bar"), names.fresh("v_bar"), names.fresh("u_bar"), names.fresh("v_bar")
    ('u_bar_', 'v_bar', 'u_bar__2', 'v_bar_2')
    """

    def __init__(self, taken: Iterable[str] = ()):
        self.taken = set(taken)
        self.wanted: dict[str, str] = {}
        self.meant: dict[str, str] = {}
        self._numbers: dict[str, int] = {}      # for each name that was wished for a number below which none is free

    def copy(self) -> Names:
        """The same names, for a function of which another version is made."""
        new = Names(self.taken)
        new.wanted, new.meant = dict(self.wanted), dict(self.meant)
        return new

    def numbered(self, wanted: str) -> str:
        """A new name: the wanted one, else numbered from 2."""
        return self.fresh(self._free(wanted))

    def give_back(self, *names: str) -> None:
        """Names that were made and are not used after all."""
        self.taken -= {*names}
        self._numbers.clear()

    def _free(self, wanted: str) -> str:
        """The wanted name, or the first of its numbered ones that is not taken."""
        number = self._numbers.get(wanted, 1)
        made = wanted if number == 1 else f"{wanted}_{number}"
        while made in self.taken:
            number += 1
            made = f"{wanted}_{number}"
        self._numbers[wanted] = number
        return made

    def fresh(self, wanted: str) -> str:
        made = wanted
        while made in self.taken and made not in self.wanted or keyword.iskeyword(made) or hasattr(builtins, made):
            made += "_"
        made = self._free(made)
        self.taken.add(made)
        self.wanted[made] = wanted
        return made

    def said(self, identifier: str) -> str:
        """The name in messages: what the user calls it."""
        return self.meant.get(identifier, identifier)
