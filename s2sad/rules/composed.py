"""Functions of whole arrays that are made of others: `normalize/pieces` writes them out, so that they need no gains.

Here stand their parameters and defaults; how the type of a result follows from the arguments is in
`infer/piece_types`.
"""
from __future__ import annotations

from s2sad.rules.array import arrays

LAW = "pieces"

for _text in (
        # shaping
        "numpy.diff(x, n=1, axis=-1)",
        "numpy.concatenate(x, axis=0)", "numpy.stack(x, axis=0)", "numpy.hstack(x)", "numpy.vstack(x)",
        "numpy.column_stack(x)", "numpy.append(x, values)",
        "numpy.expand_dims(x, axis)", "numpy.squeeze(x, axis)", "numpy.swapaxes(x, axis1, axis2)",
        "numpy.tile(x, reps)", "numpy.repeat(x, repeats, axis=None)",
        "numpy.pad(x, pad_width, mode='constant', constant_values=0.0)",
        "numpy.diag(x, k=0)", "numpy.diagonal(x, offset=0)", "numpy.tril(x, k=0)", "numpy.triu(x, k=0)",
        "numpy.trace(x, offset=0)",
        # arrays of numbers
        "numpy.eye(N, M=None, k=0)", "numpy.identity(n)", "numpy.linspace(start, stop, num=50, endpoint=True)",
        "numpy.arange(start, stop=None, step=1)",
        # reductions and running sums
        "numpy.var(x, axis=None, ddof=0, keepdims=False)", "numpy.std(x, axis=None, ddof=0, keepdims=False)",
        "numpy.prod(x, axis=None, keepdims=False)", "numpy.cumprod(x, axis=None)", "numpy.cumsum(x, axis=None)",
        "numpy.average(x, axis=None, weights=None)", "numpy.linalg.norm(x, ord=None, axis=None, keepdims=False)",
        # products, differences, sums
        "numpy.vdot(a, b)", "numpy.inner(a, b)", "numpy.trapezoid(y, x=None, dx=1.0, axis=-1)",
        "numpy.gradient(f, spacing=1.0, axis=None)", "numpy.convolve(a, v, mode='full')",
        "numpy.interp(x, xp, fp)"):
    arrays(_text, law=LAW, also=("numpy.trapz",) if "trapezoid" in _text else ())
