"""Which functions beside the elementwise ones are known to hold for complex operands; all others are refused there.

Of a rule over whole arrays in `HOLOMORPHIC` the operands that an adjoint reads are conjugated: what it gives is the
product with the conjugate of the transposed Jacobian.
"""
from __future__ import annotations

# functions of whole arrays with rules that are analytic in each operand
HOLOMORPHIC = frozenset({
    "numpy.sum", "numpy.mean", "numpy.matmul", "numpy.einsum.matmul", "numpy.dot", "numpy.outer", "numpy.linalg.solve",
    "numpy.linalg.inv", "numpy.roll", "numpy.flip", "numpy.transpose", "numpy.moveaxis", "numpy.reshape", "numpy.ravel",
    "numpy.broadcast_to", "numpy.tensordot", "numpy.einsum.tensordot", "runtime.stacked_matmul",
    "runtime.stacked_transpose"})

# transforms, whose rules are written for the inner product; `rfft` is of floats alone
COMPLEX_TRANSFORMS = frozenset(f"numpy.fft.{f}" for f in ("fft", "ifft", "irfft"))

# functions that `normalize/library/expand` writes out in such
PIECES = frozenset({
    "numpy.diff", "numpy.concatenate", "numpy.stack", "numpy.hstack", "numpy.vstack", "numpy.expand_dims",
    "numpy.swapaxes", "numpy.diag", "numpy.diagonal", "numpy.trace", "numpy.astype", "numpy.vdot", "numpy.inner",
    "numpy.cumsum", "numpy.repeat", "numpy.tile", "numpy.squeeze", "numpy.atleast_1d", "numpy.atleast_2d",
    "numpy.atleast_3d", "numpy.rot90", "numpy.fft.fft2", "numpy.fft.ifft2", "numpy.fft.fftn", "numpy.fft.ifftn",
    "numpy.fft.irfft2", "numpy.fft.irfftn", "numpy.fft.fftshift", "numpy.fft.ifftshift"})

# what makes arrays, copies them or asks for their shape
OTHER = frozenset({
    *(f"numpy.{made}{like}" for made in ("empty", "zeros", "ones", "full") for like in ("", "_like")),
    "numpy.copy", "numpy.asarray", "numpy.ascontiguousarray", "numpy.array", "numpy.shape", "numpy.size", "numpy.ndim",
    "builtins.len", "builtins.list", "numpy.isnan", "numpy.isinf", "numpy.isfinite"})

KNOWN = HOLOMORPHIC | COMPLEX_TRANSFORMS | PIECES | OTHER
