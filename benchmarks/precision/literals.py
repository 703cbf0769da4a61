"""Partials of every elementwise rule to 25 digits, for the tests that run without any extra.

    rule; parameter; point; partial

The points are those of the largest errors, and others in the rule's domain; all are numbers with all their digits.
"""
from __future__ import annotations

from pathlib import Path

from benchmarks.precision.quad import mpmath as m
from benchmarks.precision.rules import LARGEST, LEAST, Measured, exact
from benchmarks.precision.truths import truth
from s2sad import rules

PLACE = Path(__file__).parents[2] / "tests" / "rules" / "partials.txt"
DIGITS, DRAWN = 25, 12
OFTEN = 4           # points of a rule beside those of the largest errors


def write(measured: list[Measured]) -> None:
    """Writes the file anew; of rules that share a function the first."""
    lines, seen = [], set()
    for one in measured:
        given = truth(one.rule)
        assert given is not None
        if given in seen or one.rule == "numpy.where":      # whose condition is no number
            continue
        seen.add(given)
        domains = tuple(rules.find(one.rule).domain.get(p, (-2.0, 2.0)) for p in rules.find(one.rule).parameters)
        inside = [tuple(map(float, point)) for point, _ in exact(given, domains, DRAWN)[::-1][DRAWN:DRAWN + OFTEN]]
        worst = [error.point for error in one.worst.values() if error.what != "value" and error.scaled <= 4.0]
        for point in dict.fromkeys([*worst, *inside]):
            for k, parameter in enumerate(rules.find(one.rule).parameters):
                with m.workdps(max(given.digits, 60)):
                    real = given.partials[k](*map(m.mpf, point))
                    if LEAST <= abs(real) <= LARGEST:
                        lines.append(f"{one.rule}; {parameter}; {', '.join(map(repr, point))}; {m.nstr(real, DIGITS)}")
    PLACE.write_text("\n".join(lines) + "\n")
