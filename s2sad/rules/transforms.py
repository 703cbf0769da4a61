"""Discrete Fourier transforms along one axis; those along several are made of them (`normalize/pieces_of_transforms`).

The transform is a symmetric matrix F: under the inner product Re(conj(a) b) its adjoint is conj(F), the inverse
transform without its scale. Of a half spectrum all but the ends stand for two elements each.
"""
from __future__ import annotations

from s2sad.rules.array import arrays

TRANSFORMS = tuple(f"numpy.fft.{f}" for f in ("fft", "ifft", "rfft", "irfft"))

arrays("numpy.fft.fft(x, n=None, axis=-1, norm=None)", law="transformed",
       x="runtime.fft_adjoint(g, x.shape[axis], axis, norm)")
arrays("numpy.fft.ifft(x, n=None, axis=-1, norm=None)", law="transformed",
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
