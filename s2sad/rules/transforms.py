"""Discrete Fourier transforms along one axis; those along several are made of them
(`normalize/library/expansions/fft`).

The transform is a symmetric matrix F: under the inner product Re(conj(a) b) its adjoint is conj(F), the inverse
transform without its scale. Of a half spectrum all but the ends stand for two elements each.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad.rules.array import Refine, arrays
from s2sad.runtime import opposite
from s2sad.tree import AST, Constant

TRANSFORMS = tuple(f"numpy.fft.{f}" for f in ("fft", "ifft", "rfft", "irfft"))


def _whole(inverse: str) -> Refine:
    """The adjoint of a transform of all elements: the other one, without its scale."""
    def refine(operand: str, arguments: Mapping[str, AST]) -> str | None:
        size, norm = arguments["n"], arguments["norm"]
        if not isinstance(size, Constant) or size.value is not None or not isinstance(norm, Constant):
            return None
        return f"numpy.fft.{inverse}(g, axis=axis, norm={opposite(norm.value)!r})"
    return refine


arrays("numpy.fft.fft(x, n=None, axis=-1, norm=None)", law="transformed", refine=_whole("ifft"),
       x="runtime.fft_adjoint(g, x.shape[axis], axis, norm)")
arrays("numpy.fft.ifft(x, n=None, axis=-1, norm=None)", law="transformed", refine=_whole("fft"),
       x="runtime.ifft_adjoint(g, x.shape[axis], axis, norm)")
arrays("numpy.fft.rfft(x, n=None, axis=-1, norm=None)", law="half",
       x="runtime.rfft_adjoint(g, n, x.shape[axis], axis, norm)")
arrays("numpy.fft.irfft(x, n=None, axis=-1, norm=None)", law="signal",
       x="runtime.irfft_adjoint(g, x.shape[axis], axis, norm)")

# parts of derivatives
for _text, _law in (("fft_adjoint(g, size, axis, norm)", "spectrum"), ("ifft_adjoint(g, size, axis, norm)", "spectrum"),
                    ("rfft_adjoint(g, n, size, axis, norm)", "real"),
                    ("irfft_adjoint(g, size, axis, norm)", "spectrum")):
    arrays(f"runtime.{_text}", law=_law)
