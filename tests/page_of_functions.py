"""What docs/functions.md names, as expressions: of x, y (four numbers), m (4 by 4, positive definite), s (three such),
p (a permutation), k (an integer) and g (a list of edges); statements before the last `;` are written before it."""
from __future__ import annotations

PAGE = {
    "arrays of numbers": """
        np.empty(4); z[:] = x; z
        np.ndarray(4); z[:] = x; z
        np.zeros(4) + x
        np.ones((4, 4)) * x
        np.full(4, x[0])
        np.empty_like(x); z[:] = x; z
        np.zeros_like(m) + x
        np.ones_like(x) * x
        np.full_like(x, x[1])
        np.array([x[0], y[1] * x[2]])
        np.array([[x[0], y[1]], [1.0, x[3]]])
        np.array(x)
        np.copy(x) * x.copy()
        np.asarray(x) * x
        x.astype(np.float32).astype(np.float64)
        m @ np.eye(4)
        m @ np.identity(4) @ np.eye(4, k=1)
        np.tri(4) * x
        np.arange(4) * x
        np.arange(0.0, 2.0, 0.5) * x
        np.linspace(x[0], y[1], 4) * x
        np.linspace(0.0, 1.0, 4, endpoint=False) * x
        np.logspace(x[0], y[1], 4)
        np.geomspace(x[0], y[1], 4)
        np.diag(x) @ x
        np.diag(m)
        np.diag(m, 1)
        np.diagflat(x, 1)
        np.vander(x, 3)
        np.vander(x)
    """,
    "in place": """
        np.zeros(4); np.sin(x, out=z); z
        np.zeros(4); np.multiply(x, y, out=z, where=x > 0.5); z
        np.zeros(4); np.dot(m, x, out=z); z
        np.zeros((4, 4)); np.matmul(m, m, out=z); z
        np.zeros(4); np.sum(m, axis=0, out=z); z
        np.zeros(4); np.copyto(z, x); z
        np.zeros(4); np.copyto(z, x, where=x > 0.5); z
        np.zeros(4); z.fill(x[0]); z
        x * y; z.sort(); z * x
        m * 1.0; np.fill_diagonal(z, x[0]); z
        x * y; np.put(z, [0, 2], x[1]); z
        x * y; z.put([0, 2], x[1]); z
        m * 1.0; z.flat[5] = x[1]; z
        x * y; np.putmask(z, x > 0.5, x[1]); z
        x * y; np.place(z, x > 0.5, [x[1]]); z
        x * y; np.add.at(z, p, x); z
        x * y; np.subtract.at(z, p, x); z
        x * y; np.multiply.at(z, p, x); z
        x * y; np.divide.at(z, p, x); z
        x * y; np.maximum.at(z, p, x); z
        x * y; np.minimum.at(z, p, x); z
    """,
    "of ufuncs": """
        np.add.reduce(m) * np.add.accumulate(x)
        np.multiply.reduce(m, axis=1) * np.multiply.accumulate(x)
        np.maximum.reduce(m) * np.maximum.accumulate(x)
        np.minimum.reduce(m) * np.minimum.accumulate(x)
        np.add.outer(x, y) * np.multiply.outer(x, y)
        np.maximum.outer(x, y) * np.minimum.outer(x, y)
        np.subtract.outer(x, y) * np.divide.outer(x, y)
        np.power.outer(x, y) * np.hypot.outer(x, y)
        np.logaddexp.outer(x, y) * np.arctan2.outer(x, y)
        np.logaddexp.reduce(x) * np.logaddexp.accumulate(x)
        np.hypot.reduce(x)
        np.add.reduceat(x, [0, 2])
    """,
    "shape": """
        np.reshape(m, (2, 8)) * m.reshape(2, -1)
        np.ravel(m) * m.ravel() * m.flatten()
        np.reshape(m, (2, 8), order="F") * m.reshape(2, -1, order="C")
        np.ravel(m, order="F") * m.ravel("F") * m.flatten("F")
        np.atleast_3d(x) * y
        np.transpose(m) * m.T * m.transpose()
        np.transpose(s, (1, 0, 2)) * np.swapaxes(s, 0, 1)
        np.moveaxis(s, 0, 2)
        np.expand_dims(x, 1) * np.expand_dims(y, 0)
        np.squeeze(x.reshape(4, 1), axis=1)
        np.atleast_1d(x) * np.atleast_2d(y)
        np.broadcast_to(x, (3, 4))
    """,
    "moving elements": """
        np.roll(x, 1) * y
        np.roll(m, 1, axis=0) * m
        np.flip(x) * y
        np.flip(m, axis=1) * m
        np.fliplr(m) * np.flipud(m) * m
        np.rot90(m) * m
        np.rot90(s, axes=(1, 2)) * s
        np.tile(x, 3)
        np.tile(m, (2, 1))
        np.repeat(x, 2)
        np.repeat(m, 2, axis=1)
        np.repeat(x, [1, 0, 2, 3])
        np.delete(x, 1)
        np.delete(x, [0, 2])
        np.delete(x, x > 0.5)
        np.insert(x, 1, y[0])
        np.pad(x, 2)
        np.pad(m, ((1, 0), (2, 1)), mode="edge")
        np.pad(x, 2, mode="wrap")
        np.pad(x, 2, mode="reflect")
        np.pad(x, 2, mode="symmetric")
        np.pad(x, 2, mode="linear_ramp")
        np.pad(x, 2, mode="mean")
        np.pad(x, 2, mode="maximum")
        np.pad(x, 2, mode="minimum")
        np.concatenate((x, y))
        np.concatenate((m, m), axis=1)
        np.stack((x, y)) * np.stack((y, x))
        np.stack((x, y), axis=1)
        np.hstack((x, y))
        np.vstack((x, y)) * np.vstack((y, y))
        np.dstack((x, y))
        np.column_stack((x, y))
        np.block([[m, m], [m, m]])
        np.append(x, y)
        np.r_[x, y]
        np.c_[x, y]
        0.0; b, c = np.split(x, 2); b * c
        0.0; b, c = np.array_split(x, 2); b * c
        0.0; b, c = np.hsplit(m, 2); b * c
        0.0; b, c = np.vsplit(m, 2); b * c
    """,
    "reductions": """
        np.sum(m, axis=0) * x.sum()
        np.sum(m, axis=1, keepdims=True) * m
        np.sum(x, where=x > 0.5, initial=2)
        np.sum(s, axis=(0, 2))
        np.mean(m, axis=0) * x.mean()
        np.max(m, axis=0) * x.max()
        np.min(m, axis=0) * x.min()
        np.prod(m, axis=0) * x.prod()
        np.prod(x, where=x > 0.5, initial=2)
        np.var(m, axis=0) * x.var()
        np.var(x, ddof=1)
        np.std(m, axis=0) * x.std()
        np.std(x, ddof=1)
        np.ptp(m, axis=0) * np.ptp(x)
        np.nansum(m, axis=0) * np.nansum(x)
        np.nanprod(m, axis=0) * np.nanprod(x)
        np.nanmean(m, axis=0) * np.nanmean(x)
        np.nanmax(m, axis=0) * np.nanmax(x)
        np.nanmin(m, axis=0) * np.nanmin(x)
        np.nanvar(x) * np.nanvar(m, axis=0, ddof=1)
        np.nanstd(x) * np.nanstd(m, axis=0, ddof=1)
        np.cov(m)
        np.corrcoef(m)
        np.average(x, weights=y)
        np.average(m, axis=0)
        np.trace(m) * x
        np.median(x) * np.median(m, axis=0)
        np.percentile(x, 30.0) * np.percentile(m, 30.0, axis=0)
        np.quantile(x, [0.3, 0.6])
        m - np.median(m, axis=1, keepdims=True) * np.percentile(m, 30, axis=0, keepdims=True)
        np.quantile(x, 0.3) * np.quantile(m, 0.3, axis=0)
        x * np.any(x > 0.5) * np.all(x > 0.1) * np.count_nonzero(x > 0.5)
        x * np.any(m > 0.5, axis=0) * np.all(m > 0.1, axis=0)
        np.cumsum(x) * np.cumsum(m, axis=0)
        np.cumprod(x) * np.cumprod(m, axis=1)
        np.nancumsum(x)
    """,
    "places": """
        x[np.argmax(y)] * x[np.argmin(y)]
        x[np.argsort(y)] * x
        x * np.searchsorted(g, x)
        x * np.digitize(x, g)
        x[np.lexsort((y, x))] * y
        x[np.isin(p, np.array([0, 2]))]
        x[np.setdiff1d(p, np.array([0, 2]))]
        x[np.nonzero(x > 0.5)[0]]
        x[np.argwhere(x > 0.5)[:, 0]]
        x[np.flatnonzero(x > 0.5)]
        x[np.where(x > 0.5)]
        x[np.where(x > 0.5)[0]]
        0; i, j = np.unravel_index(k, (4, 4)); m[i, j] * x
        0; i, j = np.indices((4, 4)); m * i * (j + 1)
        0; i, j = np.meshgrid(x, y); i * j
        0; i, j = np.mgrid[0:4, 0:4]; m * i * j
        0; i, j = np.ogrid[0:4, 0:4]; m * i * j
        m[np.triu_indices(4)]
        m[np.tril_indices(4, -1)]
        m[np.diag_indices(4)]
        np.bincount(p, weights=x)
        np.bincount(p, weights=x, minlength=6)
        np.histogram(y, bins=3, range=(0.0, 1.5), weights=x)[0]
        np.histogram(y, 3, density=True)[0]
        np.histogram(y, 3)[1]
        np.histogram(y, bins=g, weights=x)[0]
        m[np.ix_(p, p)]
    """,
    "order and selection": """
        np.sort(x) * y
        np.sort(m, axis=0) * m
        np.take(x, p) * y
        np.take(m, p, axis=1) * m
        np.take_along_axis(m, np.argsort(m, axis=1), axis=1) * m
        m.flat[5] * x
        x.item(2) * y
        np.where(x > 0.5, x, y)
        np.select([x > 0.7, x > 0.4], [x, x * y], 0.0)
        np.nan_to_num(x)
        np.extract(x > 0.5, x)
        np.compress(x > 0.5, x)
        np.choose(p % 2, [x, y])
        np.unique(x)
        0.0; b, i = np.unique(x, return_index=True); b * y[i]
        0.0; b, i = np.unique(x, return_inverse=True); b[i] * y
        0.0; b, i = np.unique(x, return_counts=True); b * i
        m.diagonal() * np.diagonal(m)
        np.tril(m) * np.triu(m, -1)
        np.clip(x, 0.3, 0.8) * x.clip(0.3, 0.8)
    """,
    "sums and differences": """
        np.diff(x)
        np.diff(m, axis=0)
        np.diff(x, 2)
        np.ediff1d(x)
        np.gradient(x)
        np.gradient(x, 0.5)
        np.gradient(m, axis=0)
        np.trapezoid(y, x)
        np.trapezoid(m, dx=0.5, axis=0)
        np.interp(x, g, y)
        np.convolve(x, y)
        np.convolve(x, y, mode="same")
        np.convolve(x, y, mode="valid")
        np.correlate(x, y)
        np.correlate(x, y, mode="full")
        np.polyval(y, x)
        np.polynomial.polynomial.polyval(x, y)
        np.polyfit(np.arange(4.0), x, 2)
        np.polyder(x)
        np.polyint(x)
        np.polymul(x, y)
        np.ldexp(x, 2)
        np.cross(x[:3], y[:3])
    """,
    "products": """
        (m @ x) * (x @ m) * (x @ y)
        np.dot(m, x) * m.dot(y)
        np.matmul(m, m)
        np.matmul(s, m)
        np.vdot(x, y)
        np.inner(m, m)
        np.vecdot(m, m)
        np.outer(x, y)
        np.kron(m[:2, :2], m)
        np.tensordot(m, m, axes=1)
        np.tensordot(s, m, axes=([1], [0]))
        np.einsum("ij,jk->ik", m, m)
        np.einsum("ii->i", m)
        np.einsum("bij,j->bi", s, x)
        np.linalg.multi_dot([m, m, x])
        np.linalg.matrix_power(m, 3)
    """,
    "numpy.linalg": """
        np.linalg.solve(m, x)
        np.linalg.solve(m, m)
        np.linalg.solve(s, s)
        np.linalg.inv(m)
        np.linalg.inv(s)
        np.linalg.pinv(m[:, :2])
        np.linalg.det(m)
        np.linalg.det(s)
        np.linalg.slogdet(m)[1]
        np.linalg.lstsq(m[:, :2], x)[0]
        np.linalg.cholesky(m)
        np.linalg.cholesky(s)
        np.linalg.eigh(m)[0]
        0.0; b, c = np.linalg.eigh(m); (c * b) @ c.T
        np.linalg.eigvalsh(m)
        np.linalg.eigvalsh(s)
        np.linalg.qr(m)[1]
        0.0; b, c = np.linalg.qr(m); b * c
        np.linalg.qr(m, mode="r")
        0.0; b, c = np.linalg.qr(m[:2], mode="complete"); np.sum(b) * c
        0.0; b, c, d = np.linalg.svd(m, full_matrices=False); (b * c) @ d
        np.linalg.svd(m, compute_uv=False)
        np.linalg.svdvals(m)
        np.linalg.cond(m)
        np.linalg.norm(x) * np.linalg.norm(m)
        np.linalg.norm(x, 3) * np.linalg.norm(x, 1.5)
        np.linalg.norm(x, np.inf) * np.linalg.norm(x, -np.inf)
        np.linalg.norm(m, axis=0)
        np.linalg.norm(m, 3, axis=1)
        np.linalg.norm(m, "fro")
        np.linalg.norm(m, "nuc")
        np.linalg.norm(m, 1) * np.linalg.norm(m, -1)
        np.linalg.norm(m, 2) * np.linalg.norm(m, -2)
        np.linalg.norm(m, np.inf) * np.linalg.norm(m, -np.inf)
        np.linalg.norm(s, axis=(1, 2))
    """,
    "scipy.linalg": """
        scipy.linalg.solve_triangular(m, x)
        scipy.linalg.solve_triangular(m, x, lower=True)
        scipy.linalg.cholesky(m)
        scipy.linalg.cholesky(m, lower=True)
        scipy.linalg.cho_solve(scipy.linalg.cho_factor(m), x)
        scipy.linalg.lu_solve(scipy.linalg.lu_factor(m), x)
        scipy.linalg.solve_banded((1, 1), np.stack((x, y + 3.0, x)), y)
        scipy.linalg.solveh_banded(np.stack((x, y + 3.0)), y)
        scipy.linalg.solve(m, x)
        scipy.linalg.solve(m, x, assume_a="sym")
        scipy.linalg.solve(m, x, assume_a="pos", lower=True)
        scipy.linalg.solve(m, x, transposed=True)
        scipy.linalg.inv(m)
        scipy.linalg.det(m)
        scipy.linalg.norm(m)
        scipy.linalg.expm(m)
        scipy.linalg.eigvalsh(m)
        scipy.linalg.eigh(m, eigvals_only=True)
        0.0; b, c = scipy.linalg.eigh(m, driver="evd"); (c * b) @ c.T
        0.0; b, c = scipy.linalg.qr(m, mode="economic"); b * c
        0.0; b, c, d = scipy.linalg.svd(m, full_matrices=False); (b * c) @ d
        scipy.linalg.svdvals(m)
        scipy.linalg.toeplitz(x)
        scipy.linalg.toeplitz(x, y)
        scipy.linalg.block_diag(m, m)
    """,
    "scipy.special": """
        scipy.special.log_expit(x) * scipy.special.ndtr(x)
        scipy.special.exp2(x) * scipy.special.exp10(x)
        scipy.special.expm1(x) * scipy.special.log1p(x)
        scipy.special.cbrt(x) * scipy.special.gammaln(x)
        scipy.special.logsumexp(x)
        scipy.special.logsumexp(m, axis=0)
        scipy.special.logsumexp(m, axis=1, keepdims=True)
        scipy.special.softmax(x) * x
        scipy.special.softmax(m, axis=1) * m
        scipy.special.log_softmax(m, axis=0)
    """,
    "numpy.fft": """
        np.abs(np.fft.fft(x))
        np.abs(np.fft.fft(m, axis=0))
        np.abs(np.fft.fft(x, n=6, norm="ortho"))
        np.abs(np.fft.ifft(x))
        np.abs(np.fft.rfft(x, norm="forward"))
        np.fft.irfft(np.fft.rfft(x)) * y
        np.abs(np.fft.fft2(m))
        np.abs(np.fft.ifft2(m))
        np.abs(np.fft.fftn(s, axes=(1, 2)))
        np.abs(np.fft.fftn(m, s=(6, 3), axes=(0, 1)))
        np.abs(np.fft.rfft2(m))
        x * np.fft.fftfreq(4)
        x[:3] * np.fft.rfftfreq(4)
        np.fft.fftshift(x) * np.fft.ifftshift(y)
    """,
    "scipy.sparse": """
        scipy.sparse.csr_matrix((x, p, np.array([0, 1, 2, 3, 4])), shape=(4, 4)) @ y
        scipy.sparse.csc_matrix((x, p, np.array([0, 1, 2, 3, 4])), shape=(4, 4)) @ y
        scipy.sparse.coo_matrix((x, (p, p)), shape=(4, 4)) @ y
        scipy.sparse.csr_array((x, (p, p)), shape=(4, 4)) @ y
        scipy.sparse.diags(x, 0) @ y
        scipy.sparse.diags([x, x[:3]], [0, 1]) @ y
        scipy.sparse.diags_array(x, offsets=0) @ y
        scipy.sparse.spdiags(np.stack((x, y)), (0, 1), 4, 4) @ y
        (scipy.sparse.eye(4) * x[0] + scipy.sparse.identity(4)) @ y
        scipy.sparse.linalg.spsolve(scipy.sparse.csc_matrix(scipy.sparse.diags([x, x[:3]], [0, 1])), y)
        scipy.sparse.linalg.splu(scipy.sparse.csc_matrix(scipy.sparse.diags([x, x[:3]], [0, 1]))).solve(y)
        scipy.sparse.linalg.splu(scipy.sparse.csc_matrix(scipy.sparse.diags([x, x[:3]], [0, 1]))).solve(y, trans="T")
        scipy.sparse.linalg.factorized(scipy.sparse.csc_matrix(scipy.sparse.diags([x, x[:3]], [0, 1]))); z(y)
    """,
    "of sparse matrices": """
        scipy.sparse.csr_matrix((x, (p, p)), shape=(4, 4)); (y @ z) * z.dot(x) * (z.T @ y) * (z.transpose() @ x)
        scipy.sparse.csr_matrix((x, (p, p)), shape=(4, 4)); (z + z) @ y - (z - z * x[0]) @ y + (-z / x[1]) @ y
        scipy.sparse.coo_matrix((x, (p, p)), shape=(4, 4)); (z.tocsr() @ y) * (z.tocsc() @ y) * (z.tocoo() @ y)
        scipy.sparse.coo_matrix((x, (p, p)), shape=(4, 4)); z.asformat("csr").copy().diagonal() * x
        scipy.sparse.csr_matrix((x, (p, p)), shape=(4, 4)); z.toarray() * z.sum() * z.shape[0]
        scipy.sparse.csr_matrix((x, p, np.arange(5)), shape=(4, 4)); z.indices * z.data * z.nnz * z.indptr[1]
        scipy.sparse.coo_matrix((x, (p, p)), shape=(4, 4)); z.data * z.row * z.col
    """,
}


def expressions() -> list[str]:
    return [line.strip() for row in PAGE.values() for line in row.strip().splitlines()]


def function(name: str, expression: str) -> str:
    """The text of a kernel that sums the squares of what the expression gives; what is first is called z."""
    *before, last = expression.split("; ")
    lines = [f"z = {before[0]}", *before[1:]] if before else []
    return "\n    ".join([f"def {name}(x, y, m, s, p, k, g):", *lines, f"result = {last}",
                          "return np.sum(result * result)"]) + "\n"
