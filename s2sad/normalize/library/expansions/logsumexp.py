"""Expansions of sums of exponentials, and of softmax: exponentials of differences to the largest element.

The shift is the integer next to that: it has no derivative, and the results do not depend on it.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad.normalize.library.expansions.templates import CallArguments, lines


def _shifted(args: CallArguments, x: str) -> tuple[str, str, str]:
    """The text that binds `shift` and `left`, the difference to it, and the options of a sum without and with all
    axes."""
    rank = args.rank(x)
    axes = args.axes(rank) if args.has("axis") else ()
    if not axes:
        found = [f"top = numpy.max({x})", "if numpy.isfinite(top):", "    shift = numpy.rint(top)", "else:",
                 "    shift = 0.0"]
        return lines(*found, f"left = {x} - shift"), "", ""
    axis = f", axis={axes[0] if len(axes) == 1 else axes}"
    found = [f"top = numpy.max({x}{axis}, keepdims=True)",
             "shift = numpy.where(numpy.isfinite(top), numpy.rint(top), 0.0)"]
    return lines(*found, f"left = {x} - shift"), axis, f"{axis}, keepdims=True"


def _logsumexp(args: CallArguments) -> str:
    before, axis, kept = _shifted(args, "a")
    if not axis or args.flag("keepdims"):
        return lines(before, f"result = shift + numpy.log(numpy.sum(numpy.exp(left){kept}))")
    axes = args.axes(args.rank("a"))
    flat = ", ".join("0" if k in axes else ":" for k in range(args.rank("a")))
    return lines(before, f"result = shift[{flat}] + numpy.log(numpy.sum(numpy.exp(left){axis}))")


def _softmax(args: CallArguments) -> str:
    before, _, kept = _shifted(args, "x")
    return lines(before, "grown = numpy.exp(left)", f"result = grown / numpy.sum(grown{kept})")


def _log_softmax(args: CallArguments) -> str:
    before, _, kept = _shifted(args, "x")
    return lines(before, f"result = left - numpy.log(numpy.sum(numpy.exp(left){kept}))")


EXPANSIONS: dict[str, Callable[[CallArguments], str]] = {
    "scipy.special.logsumexp": _logsumexp, "scipy.special.softmax": _softmax,
    "scipy.special.log_softmax": _log_softmax,
}
