"""outside_uses: the names from outside that functions read, and the local names in them."""
from __future__ import annotations

from dataclasses import dataclass

from s2sad import tree
from s2sad.emit.literals import needs_numpy


@dataclass(frozen=True)
class OutsideUses:
    """`dotted`: the resolved names that the functions read, in the order of the text, by function; `local`: the
    names of their own (parameters included), by function."""
    dotted: dict[str, tuple[str, ...]]
    local: dict[str, frozenset[str]]

    @classmethod
    def of(cls, functions: list[tree.FunctionDef]) -> OutsideUses:
        dotted, local = {}, {}
        for function in functions:
            found: dict[str, None] = {}
            own = set()
            for node in tree.walk(function):
                if isinstance(node, tree.Name):
                    if "." in node.id:
                        found[node.id] = None
                    else:
                        own.add(node.id)
                elif isinstance(node, tree.Constant) and needs_numpy(node.value):
                    found["numpy.inf"] = None
            dotted[function.name], local[function.name] = tuple(found), frozenset(own)
        return cls(dotted, local)

    @property
    def local_names(self) -> set[str]:
        return set(self.local).union(*self.local.values())

    def room(self, room: str) -> list[str]:
        """What stands behind `room.` in the names that are read, each once, in the order of the text."""
        found = (name.split(".", 1) for names in self.dotted.values() for name in names)
        return list(dict.fromkeys(rest for first, rest in found if first == room))

    def hidden(self, name: str) -> bool:
        """Whether a function that reads this dotted name has a variable that hides what it prints as."""
        plain = name.split(".", 1)[1]
        return any(name in names and plain in self.local[function] for function, names in self.dotted.items())
