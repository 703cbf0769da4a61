"""What sums of exponentials and shares in them are made of: exponentials of what is left of the largest.

What is taken off is the integer next to that: it has no derivative, and the results do not depend on it.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.normalize.library.expansions.templates import CallArguments, lines


def _shifted(asked: CallArguments, x: str) -> tuple[str, str, str]:
    """The text that makes `shift` and `left`, which is x less that, and the options of a sum without and with all
    axes."""
    rank = asked.rank(x)
    axes = asked.axes(rank) if asked.given("axis") else ()
    if not axes:
        found = [f"top = numpy.max({x})", "if numpy.isfinite(top):", "    shift = numpy.rint(top)", "else:",
                 "    shift = 0.0"]
        return lines(*found, f"left = {x} - shift"), "", ""
    axis = f", axis={axes[0] if len(axes) == 1 else axes}"
    found = [f"top = numpy.max({x}{axis}, keepdims=True)",
             "shift = numpy.where(numpy.isfinite(top), numpy.rint(top), 0.0)"]
    return lines(*found, f"left = {x} - shift"), axis, f"{axis}, keepdims=True"


def _logsumexp(asked: CallArguments) -> str:
    before, axis, kept = _shifted(asked, "a")
    if not axis or asked.true("keepdims"):
        return lines(before, f"result = shift + numpy.log(numpy.sum(numpy.exp(left){kept}))")
    axes = asked.axes(asked.rank("a"))
    flat = ", ".join("0" if k in axes else ":" for k in range(asked.rank("a")))
    return lines(before, f"result = shift[{flat}] + numpy.log(numpy.sum(numpy.exp(left){axis}))")


def _softmax(asked: CallArguments) -> str:
    before, _, kept = _shifted(asked, "x")
    return lines(before, "grown = numpy.exp(left)", f"result = grown / numpy.sum(grown{kept})")


def _log_softmax(asked: CallArguments) -> str:
    before, _, kept = _shifted(asked, "x")
    return lines(before, f"result = left - numpy.log(numpy.sum(numpy.exp(left){kept}))")


EXPONENTIALS: dict[str, Callable[[CallArguments], str]] = {
    "scipy.special.logsumexp": _logsumexp, "scipy.special.softmax": _softmax,
    "scipy.special.log_softmax": _log_softmax,
}
