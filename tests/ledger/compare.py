"""What moved between two ledgers: kernels added and lost, verdicts, codes and texts."""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import zip_longest

from tests.ledger.replay import COLUMNS, Row


def is_hash(cell: str) -> bool:
    """Whether a cell is the hash of a text: a refusal has the code of an error, or a mark in front.

    >>> is_hash("0123456789ab"), is_hash("S201"), is_hash("!KeyError"), is_hash("-")
    (True, False, False, False)
    """
    return len(cell) == 12 and set(cell) <= set("0123456789abcdef")


@dataclass
class Changes:
    """The rows that moved, by how."""
    kinds: dict[str, list[str]] = field(default_factory=dict)

    def add(self, kind: str, what: str) -> None:
        self.kinds.setdefault(kind, []).append(what)

    def __str__(self) -> str:
        counted = [f"{len(rows):6} {kind}" for kind, rows in self.kinds.items()]
        listed = [f"{kind}: {row}" for kind, rows in self.kinds.items() for row in rows]
        return "\n".join([*listed, *counted] or ["nothing moved"])


def compare(before: Iterable[Row], after: Iterable[Row]) -> Changes:
    """What moved from one ledger to the other; both have one row for an identity and what was asked."""
    old, new = ({(r.identity, r.asked): r for r in rows} for rows in (before, after))
    found = Changes()
    for key, row in old.items():
        if key not in new:
            found.add("lost", _place(row))
    for key, row in new.items():
        if key not in old:
            found.add("added", _place(row))
        elif row.cells != old[key].cells:
            _cells(old[key], row, found)
    return found


def _cells(old: Row, new: Row, found: Changes) -> None:
    """The most that is to be said of a row whose cells differ, and of which columns."""
    kinds: dict[str, list[str]] = {}
    for column, a, b in zip_longest(COLUMNS, old.cells, new.cells, fillvalue="-"):
        if a != b:
            kind = ("another text" if is_hash(a) and is_hash(b) else f"refused ({b})" if is_hash(a) else
                    "accepted" if is_hash(b) else f"{b} in place of {a}")
            kinds.setdefault(kind, []).append(column)
    for kind, columns in kinds.items():
        found.add(kind, f"{_place(new)} [{', '.join(columns)}]")


def _place(row: Row) -> str:
    return f"{row.identity} {row.name} {row.asked} {row.places}"
