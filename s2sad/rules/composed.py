"""Functions of whole arrays that are made of others: `normalize/library/expand` expands their calls, so that they need
no adjoint of their own.

What is one expression of others stands here as such, and its type is the type of that expression. What is a program,
loops or a text that depends on the arguments' ranks, stands here with its parameters and defaults: how the type of the
result follows from the arguments is in `infer/signatures`, its text in `normalize/library/expansions`.
"""
from __future__ import annotations

from s2sad.rules.array import arrays

LAW = "composed"


def composed(text: str, value: str, also: tuple[str, ...] = ()) -> None:
    """Registers a function that is an expression of others, over its operands and options."""
    arrays(text, law=LAW, value=value, also=also)


composed("numpy.ptp(x, axis=None, keepdims=False)",
         "numpy.max(x, axis=axis, keepdims=keepdims) - numpy.min(x, axis=axis, keepdims=keepdims)")
composed("numpy.nanprod(x, axis=None, keepdims=False)",
         "numpy.prod(numpy.where(numpy.isnan(x), 1.0, x), axis=axis, keepdims=keepdims)")


# of what NumPy gives as a tuple, `part` is the number of the item (normalize/library/tuple_results); `whole` says that
# no axis but those that are named has length 1
WRITING = frozenset({"numpy.fill_diagonal", *(f"numpy.{f}.at" for f in (
    "add", "subtract", "multiply", "divide", "maximum", "minimum"))}) | {"numpy.put", "numpy.putmask"}

for _text in (
        # shaping
        "numpy.diff(x, n=1, axis=-1)",
        "numpy.concatenate(x, axis=0)", "numpy.stack(x, axis=0)", "numpy.hstack(x)", "numpy.vstack(x)", "numpy.r_(x)",
        "numpy.column_stack(x)", "numpy.append(x, values)",
        "numpy.expand_dims(x, axis)", "numpy.squeeze(x, axis=None, whole=False)", "numpy.swapaxes(x, axis1, axis2)",
        "numpy.lib.stride_tricks.sliding_window_view(x, window_shape, axis=None)",
        "numpy.tile(x, reps)", "numpy.repeat(x, repeats, axis=None)",
        "numpy.pad(x, pad_width, mode='constant', constant_values=0.0)",
        "numpy.diag(x, k=0)", "numpy.diagonal(x, offset=0, axis1=0, axis2=1)", "numpy.tril(x, k=0)",
        "numpy.triu(x, k=0)",
        "numpy.trace(x, offset=0)", "numpy.astype(x, dtype=numpy.float64)",
        "numpy.atleast_1d(x)", "numpy.atleast_2d(x)", "numpy.atleast_3d(x)", "numpy.dstack(x)",
        "numpy.rot90(x, k=1, axes=(0, 1))",
        "numpy.diagflat(x, k=0)",
        "numpy.split(x, sections, axis=0, part=None)", "numpy.array_split(x, sections, axis=0, part=None)",
        "numpy.hsplit(x, sections, part=None)", "numpy.vsplit(x, sections, part=None)",
        # stores through arrays of integers, and along a diagonal
        "numpy.fill_diagonal(x, values)",
        "numpy.add.at(x, places, values)", "numpy.subtract.at(x, places, values)",
        "numpy.multiply.at(x, places, values)", "numpy.divide.at(x, places, values)",
        "numpy.maximum.at(x, places, values)", "numpy.minimum.at(x, places, values)",
        # places, order, selection
        "numpy.searchsorted.each(a, v, side='left')", "numpy.argmax.along(x, axis=None)",
        "numpy.argsort.along(x, axis=-1, kind=None)",
        "numpy.argmin.along(x, axis=None)", "numpy.nonzero(x, part=None)", "numpy.sort(x, axis=-1)",
        "numpy.take(x, places, axis=None)", "numpy.take_along_axis(x, places, axis)",
        "numpy.select(conditions, choices, default=0)",
        "numpy.meshgrid(x, y, z=None, indexing='xy', part=None)", "numpy.indices(shape, part=None)",
        "numpy.unravel_index(place, shape, part=None)", "numpy.triu_indices(n, k=0, m=None, part=None)",
        "numpy.tril_indices(n, k=0, m=None, part=None)", "numpy.diag_indices(n, part=None)",
        "numpy.bincount(x, weights=None, minlength=0)", "numpy.median(x, axis=None, keepdims=False)",
        "numpy.percentile(x, q, axis=None, keepdims=False)", "numpy.quantile(x, q, axis=None, keepdims=False)",
        # selections, bins
        "numpy.delete(x, places, axis=None)", "numpy.insert(x, place, values, axis=None)",
        "numpy.compress(condition, x, axis=None)", "numpy.extract(condition, x)", "numpy.choose(a, choices)",
        "numpy.digitize(x, bins, right=False)", "numpy.isin(a, values, invert=False)",
        "numpy.setdiff1d(a, values)", "numpy.argwhere(x)", "numpy.lexsort(keys)",
        "numpy.unique(x, return_index=False, return_inverse=False, return_counts=False, part=None)",
        "numpy.histogram(x, bins=10, range=None, density=False, weights=None, part=None)",
        "numpy.put(x, places, values)", "numpy.putmask(x, mask, values)",
        # statistics, polynomials
        "numpy.nanmax(x, axis=None, keepdims=False)", "numpy.nanmin(x, axis=None, keepdims=False)",
        "numpy.nanvar(x, axis=None, ddof=0, keepdims=False)", "numpy.nanstd(x, axis=None, ddof=0, keepdims=False)",
        "numpy.nancumsum(x, axis=None)", "numpy.add.reduceat(x, places, axis=0)",
        "numpy.cov(m, y=None, rowvar=True, bias=False, ddof=None)", "numpy.corrcoef(m, y=None, rowvar=True)",
        "numpy.polyfit(x, y, deg)", "numpy.polyder(p)", "numpy.polyint(p)", "numpy.polymul(a, b)",
        "numpy.geomspace(start, stop, num=50, endpoint=True)",
        # arrays of numbers
        "numpy.tri(N, M=None, k=0, dtype=numpy.float64)", "numpy.eye(N, M=None, k=0, dtype=numpy.float64)",
        "numpy.identity(n, dtype=numpy.float64)",
        *(f"numpy.{_window}(M)" for _window in ("hanning", "hamming", "blackman", "bartlett")),
        "numpy.linspace(start, stop, num=50, endpoint=True)",
        "numpy.arange(start, stop=None, step=1, dtype=None)",
        # reductions and running sums
        "numpy.var(x, axis=None, ddof=0, keepdims=False)", "numpy.std(x, axis=None, ddof=0, keepdims=False)",
        "numpy.prod(x, axis=None, keepdims=False)", "numpy.cumprod(x, axis=None)", "numpy.cumsum(x, axis=None)",
        "numpy.average(x, axis=None, weights=None)", "numpy.linalg.norm(x, ord=None, axis=None, keepdims=False)",
        "numpy.linalg.cond(x, p=None)", "numpy.linalg.svd.left(a)", "numpy.linalg.svd.right(a)",
        "numpy.linalg.qr.orthogonal(a)", "numpy.linalg.qr.triangular(a)",
        "numpy.nansum(x, axis=None, keepdims=False)",
        "numpy.nanmean(x, axis=None, keepdims=False)",
        "numpy.nan_to_num(x, copy=True, nan=0.0, posinf=None, neginf=None)",
        "numpy.maximum.accumulate(x, axis=0)", "numpy.minimum.accumulate(x, axis=0)",
        "numpy.logaddexp.accumulate(x, axis=0)",
        "scipy.special.logsumexp(a, axis=None, b=None, keepdims=False)", "scipy.special.softmax(x, axis=None)",
        "scipy.special.log_softmax(x, axis=None)",
        # products, differences, sums
        "numpy.add.outer(a, b)", "numpy.subtract.outer(a, b)", "numpy.multiply.outer(a, b)",
        "numpy.divide.outer(a, b)", "numpy.power.outer(a, b)", "numpy.maximum.outer(a, b)",
        "numpy.minimum.outer(a, b)", "numpy.hypot.outer(a, b)", "numpy.logaddexp.outer(a, b)",
        "numpy.arctan2.outer(a, b)", "numpy.cross(a, b)", "numpy.vander(x, N=None, increasing=False)",
        "numpy.polyval(p, x)", "numpy.correlate(a, v, mode='valid')",
        "numpy.vdot(a, b)", "numpy.inner(a, b)", "numpy.trapezoid(y, x=None, dx=1.0, axis=-1)",
        "numpy.gradient(f, spacing=1.0, second=None, third=None, axis=None, edge_order=1, part=None)",
        "numpy.convolve(a, v, mode='full')",
        "numpy.interp(x, xp, fp, left=None, right=None)", "numpy.kron(a, b)",
        # transforms
        *(f"numpy.fft.{_f}2(x, s=None, axes=(-2, -1), norm=None)" for _f in ("fft", "ifft", "rfft", "irfft")),
        *(f"numpy.fft.{_f}n(x, s=None, axes=None, norm=None)" for _f in ("fft", "ifft", "rfft", "irfft")),
        "numpy.fft.fftshift(x, axes=None)", "numpy.fft.ifftshift(x, axes=None)",
        "numpy.fft.fftfreq(n, d=1.0)", "numpy.fft.rfftfreq(n, d=1.0)",
        # matrices of a certain form, as scipy.linalg has them
        "scipy.linalg.mirrored(a, lower=False)", "scipy.linalg.qr.triangular(a)",
        "scipy.linalg.toeplitz(c, r=None)", "scipy.linalg.block_diag(a, b)",
        "scipy.linalg.solveh_banded(a, b, lower=False)",
        # sparse matrices
        "scipy.sparse.entries(data, c)", "scipy.sparse.along(values, size)"):
    arrays(_text, law=LAW, also=("numpy.trapz",) if "trapezoid" in _text else ())
