"""Expansions of Fourier transforms along several axes, in those along one; of shifts and frequencies."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.signatures.fft import transformed_axes
from s2sad.normalize.library.expansions.templates import CallArguments, lines, size


def _along_axes(args: CallArguments, functions: list[tuple[str, int]]) -> str:
    """One transform after the other, each with the number of its axis among those asked for."""
    axes = transformed_axes(args.arguments, args.rank("x")) or []
    sizes = [f"n={args.let('size', node)}, " for node in args.items("s")] if args.has("s") else [""] * len(axes)
    norm = f", norm={args.text('norm')!r}" if args.has("norm") else ""
    names = ["x", *(f"along{k}" for k in range(1, len(functions))), "result"]
    return lines(*(f"{new} = numpy.fft.{function}({old}, {sizes[k]}axis={axes[k]}{norm})"
                   for old, new, (function, k) in zip(names, names[1:], functions)))


def _axis_count(args: CallArguments) -> int:
    return len(transformed_axes(args.arguments, args.rank("x")) or [])


def _all_axes(function: str) -> Callable[[CallArguments], str]:
    """The last axis first, as NumPy does it."""
    return lambda args: _along_axes(args, [(function, k) for k in reversed(range(_axis_count(args)))])


def _rfftn(args: CallArguments) -> str:
    last = _axis_count(args) - 1
    return _along_axes(args, [("rfft", last), *(("fft", k) for k in reversed(range(last)))])


def _irfftn(args: CallArguments) -> str:
    last = _axis_count(args) - 1
    return _along_axes(args, [*(("ifft", k) for k in range(last)), ("irfft", last)])


def _shift(sign: str) -> Callable[[CallArguments], str]:
    def made(args: CallArguments) -> str:
        axes = args.axes(args.rank("x"), "axes")
        names = ["x", *(f"moved{k}" for k in range(1, len(axes))), "result"]
        return lines(*(f"{new} = numpy.roll({old}, {sign}({size('x', k)} // 2), axis={k})"
                       for old, new, k in zip(names, names[1:], axes)))
    return made


def _frequencies(args: CallArguments) -> str:
    return lines("places = numpy.arange(n)", "result = ((places + n // 2) % n - n // 2) * (1.0 / (n * d))")


def _half_frequencies(args: CallArguments) -> str:
    return lines("places = numpy.arange(n // 2 + 1)", "result = places * (1.0 / (n * d))")


EXPANSIONS: dict[str, Callable[[CallArguments], str]] = {
    **{f"numpy.fft.{f}{several}": made for several in ("2", "n") for f, made in (
        ("fft", _all_axes("fft")), ("ifft", _all_axes("ifft")), ("rfft", _rfftn), ("irfft", _irfftn))},
    "numpy.fft.fftshift": _shift(""), "numpy.fft.ifftshift": _shift("-"), "numpy.fft.fftfreq": _frequencies,
    "numpy.fft.rfftfreq": _half_frequencies,
}
