"""What transforms along several axes are made of: transforms along one; and shifts and frequencies."""
from __future__ import annotations

from collections.abc import Callable

from s2sad.infer.signatures.fft import transformed_axes
from s2sad.normalize.library.expansions.templates import CallArguments, lines, size


def _steps(asked: CallArguments, functions: list[tuple[str, int]]) -> str:
    """One transform after the other, each with the number of its axis among those asked for."""
    axes = transformed_axes(asked.arguments, asked.rank("x")) or []
    sizes = [f"n={asked.let('size', node)}, " for node in asked.items("s")] if asked.given("s") else [""] * len(axes)
    norm = f", norm={asked.text('norm')!r}" if asked.given("norm") else ""
    names = ["x", *(f"along{k}" for k in range(1, len(functions))), "result"]
    return lines(*(f"{new} = numpy.fft.{function}({old}, {sizes[k]}axis={axes[k]}{norm})"
                   for old, new, (function, k) in zip(names, names[1:], functions)))


def _count(asked: CallArguments) -> int:
    return len(transformed_axes(asked.arguments, asked.rank("x")) or [])


def _every(function: str) -> Callable[[CallArguments], str]:
    """The last axis first, as NumPy does it."""
    return lambda asked: _steps(asked, [(function, k) for k in reversed(range(_count(asked)))])


def _half(asked: CallArguments) -> str:
    last = _count(asked) - 1
    return _steps(asked, [("rfft", last), *(("fft", k) for k in reversed(range(last)))])


def _signal(asked: CallArguments) -> str:
    last = _count(asked) - 1
    return _steps(asked, [*(("ifft", k) for k in range(last)), ("irfft", last)])


def _shift(sign: str) -> Callable[[CallArguments], str]:
    def made(asked: CallArguments) -> str:
        axes = asked.axes(asked.rank("x"), "axes")
        names = ["x", *(f"moved{k}" for k in range(1, len(axes))), "result"]
        return lines(*(f"{new} = numpy.roll({old}, {sign}({size('x', k)} // 2), axis={k})"
                       for old, new, k in zip(names, names[1:], axes)))
    return made


def _frequencies(asked: CallArguments) -> str:
    return lines("places = numpy.arange(n)", "result = ((places + n // 2) % n - n // 2) * (1.0 / (n * d))")


def _half_frequencies(asked: CallArguments) -> str:
    return lines("places = numpy.arange(n // 2 + 1)", "result = places * (1.0 / (n * d))")


TRANSFORMS: dict[str, Callable[[CallArguments], str]] = {
    **{f"numpy.fft.{f}{several}": made for several in ("2", "n") for f, made in (
        ("fft", _every("fft")), ("ifft", _every("ifft")), ("rfft", _half), ("irfft", _signal))},
    "numpy.fft.fftshift": _shift(""), "numpy.fft.ifftshift": _shift("-"), "numpy.fft.fftfreq": _frequencies,
    "numpy.fft.rfftfreq": _half_frequencies,
}
