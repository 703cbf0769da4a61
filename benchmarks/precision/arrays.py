"""Errors of functions of whole arrays and of their options: every line of docs/functions.md's tests, by norm.

Each expression stands in a kernel that sums the squares of what it gives, at well-conditioned arguments of four
numbers, so that an error is a matter of the rule; it is relative to the largest element of a gradient, in units of
2**-53.
"""
from __future__ import annotations

import re
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import s2sad
from benchmarks.precision import reference
from benchmarks.precision.rules import loaded
from benchmarks.tables import Table
from tests.docs.functions import FLOATS, PAGE, arguments, function

UNIT = 2.0 ** -53
ZERO = 1e-25        # a derivative that is 0 is this with 113 bits
IMPORTS = "import scipy.linalg\nimport scipy.sparse.linalg\n\n\n"


@dataclass(frozen=True)
class Found:
    """The errors of one expression in units of 2**-53: of adjoint and tangent; and how far the reference's part."""
    group: str
    expression: str
    adjoint: float
    tangent: float
    honest: float


def measured(groups: Sequence[str] = tuple(PAGE)) -> tuple[list[Found], Counter[str]]:
    """The errors of all expressions, and for how many there is no reference, by what is missing."""
    found, missing = [], Counter()
    with tempfile.TemporaryDirectory() as folder:
        for group in groups:
            for expression in map(str.strip, PAGE[group].strip().splitlines()):
                kernel = loaded(IMPORTS + function("kernel", expression), Path(folder))
                if "float32" in expression:
                    continue
                wrt = tuple(n for n in FLOATS if re.search(rf"\b{n}\b", expression))
                try:
                    found.append(_errors(group, expression, kernel, wrt))
                except (reference.NoReference, s2sad.S2sadError) as why:
                    missing[str(why) if isinstance(why, reference.NoReference) else f"`{expression}`, refused"] += 1
    return found, missing


def _errors(group: str, expression: str, kernel: Callable[..., Any], wrt: tuple[str, ...]) -> Found:
    given = arguments()
    exact = reference.gradient(kernel, given, wrt)
    differentiated = s2sad.differentiate(kernel, engine="numpy")
    gained = s2sad.vjp(differentiated, given, {"return": 1.0}, wrt=wrt)
    along = {n: np.cos(1.0 + np.arange(exact[n].size)).reshape(exact[n].shape) for n in wrt}
    change = s2sad.jvp(differentiated, given, along)["return"]
    real = reference.tangent(kernel, given, along)["return"]
    size = sum(np.sum(np.abs(exact[n] * along[n])) for n in wrt)
    size = size if size > ZERO else size * 0 + 1
    total = sum(np.sum(exact[n] * along[n]) for n in wrt)
    tangent = float(abs(real - change) / size)
    return Found(group, expression, max(_apart(gained[n], exact[n]) for n in wrt) / UNIT,
                 tangent / UNIT, float(abs(total - real) / size))


def _apart(found: Any, exact: Any) -> float:
    """The relative error by norm; of a gradient that is 0, as of solve(m, m), the absolute one."""
    if np.max(np.abs(exact)) > ZERO:
        return reference.relative_error(found, exact)
    return float(np.max(np.abs(found)))


def table(found: Sequence[Found], missing: Counter[str]) -> Table:
    """For each group of functions the median and the largest error."""
    made = Table("Functions of whole arrays: errors by norm, in units of 2**-53",
                 ("functions", "expressions", "adjoint, median", "largest", "tangent, median", "largest", "of"))
    for group in PAGE:
        mine = [f for f in found if f.group == group]
        if mine:
            worst = max(mine, key=lambda f: max(f.adjoint, f.tangent))
            made.rows.append((group, str(len(mine)), *(f"{v:.2g}" for v in (
                np.median([f.adjoint for f in mine]), max(f.adjoint for f in mine),
                np.median([f.tangent for f in mine]), max(f.tangent for f in mine))), f"`{worst.expression}`"))
    made.notes = [f"Adjoint and tangent of the references part by {max(f.honest for f in found):.0e} at most. "
                  f"Of {len(found) + sum(missing.values())} expressions {sum(missing.values()) or 'none'} "
                  f"{'has' if not missing else 'have'} no reference of 113 bits"
                  + "".join(f"{'; ' if k else ': '}{count} for {what}"
                            for k, (what, count) in enumerate(missing.most_common())) + "."]
    return made
