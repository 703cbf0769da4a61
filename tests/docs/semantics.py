"""The rows of the tables in docs/semantics.md: a call for each role, annotation and choice of wrt and of, executed.

`python -m tests.docs.semantics` prints the tables; the test compares them with the page, under both engines.
"""
from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from s2sad import (
    Active, Const, Differentiated, Duplicated, DuplicatedNoNeed, Reverse, S2sadError, S2sadWarning, autodiff, gradient,
    vjp,
)


def roles(out, u, both, part, work, other, k):
    total = 0.0
    for i in range(u.size):
        work[i] = k * u[i] * u[i]
        out[i] = work[i] + both[i]
        both[i] = both[i] * u[i]
        total += work[i]
    part[0] = 3.0 * u[0]
    return total


ROLES = {"out": "out", "u": "in", "both": "in-out", "part": "partly written", "work": "work array",
         "other": "untouched", "k": "a float"}
ENTRY = {"out": [9.0, 9.0], "u": [1.0, 2.0], "both": [3.0, 4.0], "part": [5.0, 6.0], "work": [7.0, 8.0],
         "other": [1.0, 1.0], "k": 2.0}
ARRAYS = [n for n in ENTRY if n != "k"]
WRITTEN = ["out", "both", "part", "work"]
SHADOW = [1.0, 10.0]
HEAD = ("argument", "role", "said", "wrt", "of", "shadow before", "shadow after, or result", "content after")


@dataclass(frozen=True)
class Row:
    argument: str
    said: str
    wrt: str
    of: str

    def cells(self, engine: str) -> tuple[str, ...]:
        return (f"`{self.argument}`", ROLES[self.argument], self.said, self.wrt, self.of, *Play(self, engine).outcome())


def rows() -> Iterator[Row]:
    for argument in ROLES:
        for said in ("`Const`", "`Active`", "`Duplicated`", "`DuplicatedNoNeed`"):
            yield Row(argument, said, "", "")
        for said in ("`f.adjoint`", "`vjp`"):
            for wrt, of in (("yes", "yes"), ("yes", "no"), ("no", "yes"), ("no", "no")):
                yield Row(argument, said, wrt, of)
        yield Row(argument, "`gradient`", "yes", "")


class Play:
    """One row played: fresh values, shadows of ones beside the argument's own, the seed of the result 0."""

    def __init__(self, row: Row, engine: str):
        self.row, self.engine = row, engine
        self.values: dict[str, Any] = {n: np.array(v) if isinstance(v, list) else v for n, v in ENTRY.items()}
        self.shadows = {n: np.array(SHADOW) if n == row.argument else np.ones(2) for n in ARRAYS}
        self.result: Any = None

    def outcome(self) -> tuple[str, str, str]:
        """The cells: shadow before, shadow after or result, content after."""
        said = self.row.said.strip("`")
        has_shadow = self.row.argument in ARRAYS and (said.startswith("Duplicated") or said == "f.adjoint" and
                                                      "yes" in (self.row.wrt, self.row.of))
        before = shown(SHADOW) if has_shadow else ""
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", S2sadWarning)
                getattr(self, {"f.adjoint": "adjoint", "vjp": "vjp", "gradient": "gradient"}.get(said, "autodiff"))()
        except S2sadError as error:
            return before, f"refused: {error.diagnostics[0].code}", shown(self.values[self.row.argument])
        after = self.shadows[self.row.argument] if has_shadow else self.result
        if has_shadow and said == "f.adjoint" and self.row.wrt == "no":
            after = "consumed"
        warned = ", and a warning" if any(f"'{self.row.argument}'" in str(w.message) for w in caught) else ""
        return before, shown(after) + warned, self.content(said)

    def content(self, said: str) -> str:
        loose = said == "DuplicatedNoNeed" or said == "f.adjoint"
        if loose and self.row.argument in WRITTEN:
            return "unspecified"
        return shown(self.values[self.row.argument])

    def autodiff(self) -> None:
        given = []
        for name, value in self.values.items():
            kind = {"Const": Const, "Active": Active, "Duplicated": Duplicated, "DuplicatedNoNeed": DuplicatedNoNeed}[
                self.row.said.strip("`") if name == self.row.argument else "Active" if name == "k" else "Duplicated"]
            twice = kind in (Duplicated, DuplicatedNoNeed)
            given.append(kind(value, self.shadows.get(name, 0.0)) if twice else kind(value))
        found = autodiff(Reverse, Differentiated(roles, engine=self.engine), *given, seed=0.0)
        self.result = found[0] if self.row.argument == "k" and found else None

    def chosen(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        wrt = tuple(n for n in ENTRY if n != self.row.argument or self.row.wrt == "yes")
        of = tuple(n for n in ENTRY if n in WRITTEN and n != self.row.argument)
        return wrt, of + ((self.row.argument,) if self.row.of == "yes" else ())

    def adjoint(self) -> None:
        wrt, of = self.chosen()
        given: list[Any] = []
        for name, value in self.values.items():
            given += [value, self.shadows[name]] if name in ARRAYS and name in (*wrt, *of) else [value]
        found = Differentiated(roles, wrt, of, self.engine).adjoint(*given)
        self.result = found[-1] if self.row.argument == "k" and found else None

    def vjp(self) -> None:
        wrt, of = self.chosen()
        seeds = {n: self.shadows.get(n, np.ones(2)) for n in of}
        found = vjp(Differentiated(roles, engine=self.engine), tuple(self.values.values()), seeds, wrt)
        self.result = found.get(self.row.argument)

    def gradient(self) -> None:
        f = gradient(Differentiated(roles, engine=self.engine), self.row.argument)
        self.result = f(*self.values.values())


def shown(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, str):
        return value
    if isinstance(value, float):
        return f"{value:g}"
    return f"[{', '.join(f'{v:g}' for v in value)}]"


def table(engine: str) -> list[str]:
    lines = [f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
    return lines + [f"| {' | '.join(row.cells(engine))} |" for row in rows()]


if __name__ == "__main__":
    print("\n".join(table("numpy")))
