"""The second half of `docs/accuracy.md`: its sections are written anew from what was measured, the others stay."""
from __future__ import annotations

import importlib.util
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.peers.document import draw
from benchmarks.peers.sections import Part, Picture
from benchmarks.robustness import conditions, pictures, published, runs, zeros
from benchmarks.robustness.cases import Case, apart, gradients
from benchmarks.tables import Table, markdown

DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "accuracy.md"

LAW = """A derivative is a sum, over the ways from an input to an output, of products of partials and a seed; a product
with a factor that is exactly 0 is 0, whatever its other factors are, inf and nan included. So what a choice does not
take, and what has a seed or a tangent of 0, gives nothing, in both modes; nothing is asked where all is finite. What is
left open is in [Limits](limits.md). Tested by `tests/benchmarks/test_robustness.py` and
`tests/differentiate/test_zero_law.py`."""
KINKS = """Where a function is not differentiable one side is taken, always the same one; `explain` lists the places. Of
equal eigenvalues each has the derivative along the vector that LAPACK gives it. Tested by
`tests/benchmarks/test_robustness.py`."""
PUBLISHED = """What users of other tools have reported, or what these document, as NumPy kernels. What is differentiable
is right; where it is not, the derivative is that of the side taken, and `explain` lists the place."""
RUNS = """Adjoint and tangent are derivatives of the same steps: how far they are apart, over the gradient's largest
element, is rounding times the condition of the steps. In a chaotic run the gradient grows exponentially with the
horizon, and so does its error against that of the exact run, for the run itself is another one from its first rounding
on: where the numbers have no correct digit left, the adjoint is still exact for the steps that were computed, and says
nothing of the system any more. Lorenz's system comes there behind time 40, the double pendulum that is let go at large
angles behind time 25. Errors are against differences of 120 digits, of the shock, whose limiter chooses by what it
compares, against 113 bits. Tested by `tests/benchmarks/test_robustness.py`."""
UNWRITTEN = """`pytest --poison` fills whatever a derivative allocates with nan until it is written, under every engine:
work arrays, tapes and what they grow by, those that are kept between calls, and the scratch arrays of the run time;
integers hold a number that is no index. Whatever reads what was not written shows. A sample runs always,
`tests/analyze/test_poison.py`, with derivatives from which a store was taken, which it must find.
`python -m tests.harness.bulk --poison` does the same for random programs. Without the passes that may not change
rounding, derivatives are the same bit for bit: `tests/test_passes.py`, and [Writing a pass](writing-a-pass.md) lists
them."""


def case_table(title: str, cases: Sequence[Case]) -> tuple[Table, int]:
    """A line for each case, and how many are not as they should be."""
    sourced = any(c.source for c in cases)
    table = Table(title, ("what", *(["reported of"] if sourced else []), "gradient", "adjoint's error",
                          "tangent's error", "rule", "right"))
    wrong = 0
    for case in cases:
        adjoint, tangents = gradients(case)
        errors = apart(adjoint, case.expected), apart(tangents, case.expected)
        right = max(errors) <= case.limit
        wrong += not right
        table.rows.append((case.what, *([case.source] if sourced else []), _short(adjoint), *map(_units, errors),
                           "; ".join(filter(None, (case.rule, case.kink and "explained"))), "yes" if right else "NO"))
    table.notes.append("Errors against values worked out by hand, in units of rounding (2.2e-16); absolute where 0 is "
                       "right.")
    return table, wrong


def measured(quick: bool) -> dict[str, Any]:
    """All that is measured, but for the cases, which are fast."""
    long = {"brusselator": 20_000, "robertson": 400, "relaxation": 100_000, "shock": 200}
    horizons = {"lorenz": range(500, 5001, 500), "pendulum": range(500, 5001, 500)}
    if quick:
        long = {name: steps // 20 for name, steps in long.items()}
        horizons = {name: range(100, 301, 100) for name in horizons}
    exact = importlib.util.find_spec("mpmath") is not None
    return {
        "systems": conditions.systems(range(13)), "means": conditions.means(range(0, 9, 2)),
        "dependent": conditions.dependent(range(0, 9, 2)), "sums": conditions.sums(10 ** (5 if quick else 7)),
        "count": 10 ** (5 if quick else 7),
        "long": [_run(name, steps, exact) for name, steps in long.items()],
        "chaotic": {name: [_run(name, steps, exact) for steps in found] for name, found in horizons.items()}}


def _run(name: str, steps: int, exact: bool) -> dict[str, Any]:
    adjoint, tangents = runs.both(name, steps, "numba")
    found: dict[str, Any] = {"name": name, "steps": steps, "time": steps * float(runs.RUNS[name][1](steps)[-1])
                             if name != "shock" else float(steps), "gradient": float(np.max(np.abs(adjoint))),
                             "apart": runs.disagreement(adjoint, tangents)}
    if exact:
        true = runs.exact(name, steps)
        top = max(abs(t) for t in true)
        found["error"] = float(max(abs(t - float(a)) for t, a in zip(true, adjoint)) / top)
        found["true"] = float(top)
    return found


def sections(found: dict[str, Any]) -> dict[str, list[Part]]:
    """The document's sections by their headings."""
    tables = [case_table(title, cases)[0] for title, cases in (
        ("What is not taken", zeros.CASES), ("Large, small and saturated", zeros.EXTREMES),
        ("Conventions", zeros.KINKS), ("Failures of others", published.CASES))]
    return {"Zeros and choices": [LAW, *tables[:2], *pictures.of_conditions(found), *_tables_of_conditions(found)],
            "Kinks": [KINKS, tables[2], PUBLISHED, tables[3]],
            "Long and chaotic runs": [RUNS, *pictures.of_runs(found), _table_of_runs(found)],
            "Nothing unwritten is read": [UNWRITTEN]}


def _tables_of_conditions(found: dict[str, Any]) -> list[Part]:
    means = Table("Gradient of a variance of 100 numbers around a mean",
                  ("mean", "`np.var(x)`", "`mean(x * x) - mean(x) ** 2`"))
    means.rows = [(f"{r['mean']:.0e}", f"{r['var']:.1e}", f"{r['squares']:.1e}") for r in found["means"]]
    means.notes = ["Largest error over the largest element, against fractions: the rule of `np.var` subtracts the mean "
                   "first."]
    dependent = Table("Gram and Schmidt of three vectors, two of which are nearly dependent",
                      ("condition", "largest element of the gradient", "adjoint against tangent"))
    dependent.rows = [(f"{r['condition']:.0e}", f"{r['gradient']:.1e}", f"{r['apart']:.1e}")
                      for r in found["dependent"]]
    sums = Table(f"Sums of {found['count']:.0e} numbers, and their derivative by a factor",
                 ("dtype", "written as", "engine", "error of the value", "error of the derivative"))
    sums.rows = [(r["dtype"], r["sum"], r["engine"], f"{r['value']:.1f}", f"{r['gradient']:.1f}")
                 for r in found["sums"]]
    sums.notes = ["In units of the dtype's rounding, against exact sums. Compiled, the sum of a product is one loop: "
                  "its terms are added one after the other where nothing says that their order is free."]
    return [means, dependent, sums]


def _table_of_runs(found: dict[str, Any]) -> Table:
    table = Table("Long runs", ("run", "steps", "largest element of the gradient", "adjoint against tangent",
                                "error against many digits"))
    table.rows = [(r["name"], str(r["steps"]), f"{r['gradient']:.1e}", f"{r['apart']:.1e}",
                   f"{r['error']:.1e}" if "error" in r else "") for r in found["long"]]
    return table


def _units(error: float) -> str:
    return "0" if error == 0.0 else f"{error:.1f}" if error >= 0.05 else f"{error:.0e}"


def _short(values: np.ndarray) -> str:
    return ", ".join("nan" if math.isnan(v) else f"{v:.4g}" for v in np.ravel(values))


def write(found: dict[str, Any], document: Path = DOCUMENT) -> None:
    """Puts the sections into the document, and the pictures beside it."""
    folder = document.with_suffix("")
    folder.mkdir(exist_ok=True)
    (folder / "robustness.json").write_text(json.dumps(found, indent=1) + "\n")
    text = document.read_text(encoding="utf-8")
    for heading, parts in sections(found).items():
        text = filled(text, heading, "\n\n".join(_text(part, folder) for part in parts))
    document.write_text(text, encoding="utf-8")


def filled(text: str, heading: str, content: str) -> str:
    """The text with new content under a heading.

    >>> filled("# A\\n\\n## B\\n\\nold\\n\\n## C\\n", "B", "new")
    '# A\\n\\n## B\\n\\nnew\\n\\n## C\\n'
    """
    before, mark, rest = text.partition(f"## {heading}\n")
    if not mark:
        raise ValueError(f"the document has no section {heading!r}")
    _, following, after = rest.partition("\n## ")
    return f"{before}{mark}\n{content}\n" + (f"\n## {after}" if following else "")


def _text(part: Part, folder: Path) -> str:
    if isinstance(part, Table):
        return markdown(part)
    if isinstance(part, Picture):
        drawn = draw(part, folder)
        return f"![{part.caption}]({folder.name}/{part.name}.svg)" if drawn else f"(A picture: {part.caption})"
    return part


__all__ = ["case_table", "measured", "sections", "write"]
