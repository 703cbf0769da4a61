"""Products, matrices, transforms and special functions."""

ROWS = {
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
    "cmath": """
        abs(cmath.exp(x[0]) * cmath.log(1j * x[1]) + cmath.log10(x[2]) + cmath.sqrt(-x[3]))
        abs(cmath.sin(x[0]) + cmath.cos(x[1]) * cmath.tan(x[2]) + 1j * cmath.asin(x[0]) * cmath.acos(x[1]))
        abs(cmath.sinh(x[0]) + cmath.cosh(x[1]) * cmath.tanh(x[2]) + 1j * cmath.atan(x[3]) * cmath.acosh(x[0]))
        abs(cmath.asinh(x[0]) + 1j * cmath.atanh(x[1])) * cmath.phase(complex(x[0], x[1]))
        sum(cmath.polar(complex(x[0], y[1]))) * abs(cmath.rect(x[2], y[3]) + 1.0)
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
