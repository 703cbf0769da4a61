"""The parts of `docs/accuracy.md` that are measured: each stands between two comments and is written anew."""
from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from benchmarks.precision.rules import Error, Measured
from benchmarks.precision.truths import truth
from benchmarks.tables import Table, markdown

DOCUMENT = Path(__file__).parents[2] / "docs" / "accuracy.md"
LIMIT = 4.0
VALUE = "the value is NumPy's, SciPy's or the system's own"
RANGE = "a / b beyond the range of numbers"
REASONS = {
    "power": "an exponent near 0 loses digits when 1 is subtracted from it; the way around takes a second power",
    "scipy.special.rel_entr": RANGE,
    "scipy.special.kl_div": RANGE,
    "scipy.special.gammaln": "SciPy's digamma, which the engine NumPy calls",
}


def replaced(name: str, tables: Sequence[Table], document: Path = DOCUMENT) -> None:
    """Writes the part of the document that has this name."""
    lines = list(map(markdown, tables))
    begin, end = f"<!-- {name}: written by python -m benchmarks precision -->", f"<!-- end of {name} -->"
    pattern = re.compile(re.escape(begin) + ".*?" + re.escape(end), re.DOTALL)
    text, count = pattern.subn(lambda _: "\n\n".join([begin, *lines, end]), document.read_text(encoding="utf-8"))
    if count != 1:
        raise ValueError(f"{document} has {count} parts {name!r}")
    document.write_text(text, encoding="utf-8")


def rules_tables(measured: Sequence[Measured]) -> list[Table]:
    """All rules; what is worse than the limit; and the edges of the numbers."""
    return [_all(measured), _worse(measured), _edges(measured)]


def _all(measured: Sequence[Measured]) -> Table:
    kinds = [(what, engine) for what in ("value", "tangent", "adjoint") for engine in ("numpy", "numba")]
    rows: dict[tuple[str, ...], list[str]] = {}
    for one in measured:
        figures = tuple(_figure(one.worst.get(kind)) for kind in kinds)
        rows.setdefault((str(one.points), *figures), []).append(f"`{one.rule}`")
    return Table("Largest errors, in ulp", ("rules", "points", *(f"{w}, {'NumPy' if e == 'numpy' else 'Numba'}"
                                                               for w, e in kinds)),
                 [(", ".join(names), *figures) for figures, names in rows.items()],
                 ["Rules with the same figures share a line. An error above 4 is divided by the condition of what it "
                  "is the error of, where that is above 1."])


def _figure(error: Error | None) -> str:
    return "0" if error is None else f"{error.scaled:.2f}" if error.scaled < 100.0 else f"{error.scaled:.1e}"


def _worse(measured: Sequence[Measured]) -> Table:
    """One line for the rules of one function, its value apart from its derivatives."""
    found: dict[tuple[int, bool], list[tuple[str, Error]]] = {}
    for one in measured:
        for error in one.worst.values():
            if error.scaled > LIMIT:
                found.setdefault((id(truth(one.rule)), error.what == "value"), []).append((one.rule, error))
    table = Table(f"Worse than {LIMIT:g} ulp", ("rules", "of", "engines", "at", "error", "condition", "reason"))
    for (_, value), errors in found.items():
        rule, worst = max(errors, key=lambda e: e[1].scaled)
        table.rows.append((
            ", ".join(dict.fromkeys(f"`{r}`" for r, _ in errors)), "value" if value else "partials",
            ", ".join(dict.fromkeys("NumPy" if e.engine == "numpy" else "Numba" for _, e in errors)), _point(worst),
            f"{worst.ulp:.3g}", f"{worst.condition:.2g}", _reason(rule, worst.what)))
    return table


def _reason(rule: str, what: str) -> str:
    if what == "value":
        return RANGE if REASONS.get(rule) == RANGE else VALUE
    return REASONS.get("power" if "**" in rule or rule.endswith(("pow", "power")) else rule, "none is known")


def _edges(measured: Sequence[Measured]) -> Table:
    table = Table("At the edges of the numbers", ("rules", "of", "for example at", "is", "should be"))
    found: dict[tuple[int, bool], list[tuple[str, Error]]] = {}
    for one in measured:
        for error in one.edges:
            found.setdefault((id(truth(one.rule)), error.what == "value"), []).append((one.rule, error))
    for (_, value), errors in found.items():
        _, worst = max(errors, key=lambda e: e[1].ulp)
        table.rows.append((", ".join(dict.fromkeys(f"`{r}`" for r, _ in errors)), "value" if value else "partials",
                           _point(worst), f"{worst.found:.4g}", f"{worst.expected:.4g}"))
    table.notes = ["Errors above 4 ulp where an argument, the value or the partial is below 2.2e-308, or above the "
                   "largest number."]
    return table


def _point(error: Error) -> str:
    return ", ".join(f"{p:.6g}" for p in error.point)
