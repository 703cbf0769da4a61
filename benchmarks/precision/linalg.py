"""Linear algebra on quads, written out: small matrices.

Where a decomposition is unique but for signs they are those of NumPy's in doubles, so that both are the same function.
"""
from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.precision.quad import QUAD

SMALL = 1e-33


def _eye(n: int) -> Any:
    return np.eye(n).astype(QUAD)


def matmul(a: Any, b: Any) -> Any:
    """`a @ b`: numpy-quaddtype multiplies right what is contiguous only."""
    a, b = np.ascontiguousarray(a, QUAD), np.ascontiguousarray(b, QUAD)
    return a @ b if a.size and b.size else np.zeros(np.matmul(a.astype(float), b.astype(float)).shape, QUAD)[()]


def solve(a: Any, b: Any) -> Any:
    """`numpy.linalg.solve`: elimination with partial pivoting."""
    a, b = np.array(a, QUAD), np.array(b, QUAD)
    if a.ndim > 2:
        return np.array([solve(m, r) for m, r in zip(a, b)])
    rest = b.reshape(b.shape[0], -1)
    order, sign = _eliminate(a)
    rest = rest[order]
    n = a.shape[0]
    for k in range(n):
        rest[k + 1:] -= a[k + 1:, k, None] * rest[k]
    for k in range(n - 1, -1, -1):
        rest[k] /= a[k, k]
        rest[:k] -= a[:k, k, None] * rest[k]
    return rest.reshape(b.shape)


def _eliminate(a: Any) -> tuple[Any, int]:
    """Factors a matrix in place; the order of its rows, and the sign of that."""
    n, sign = a.shape[0], 1
    order = np.arange(n)
    for k in range(n):
        pivot = k + int(np.argmax(np.abs(a[k:, k])))
        if a[pivot, k] == 0:
            raise np.linalg.LinAlgError("Singular matrix")
        if pivot != k:
            a[[k, pivot]], order[[k, pivot]], sign = a[[pivot, k]], order[[pivot, k]], -sign
        a[k + 1:, k] /= a[k, k]
        a[k + 1:, k + 1:] -= a[k + 1:, k, None] * a[k, k + 1:]
    return order, sign


def inv(a: Any) -> Any:
    """`numpy.linalg.inv`."""
    return solve(a, _eye(len(a)))


def det(a: Any) -> Any:
    """`numpy.linalg.det`."""
    a = np.array(a, QUAD)
    try:
        _, sign = _eliminate(a)
    except np.linalg.LinAlgError:
        return a[0, 0] * 0
    return np.prod(np.diagonal(a)) * sign


def slogdet(a: Any) -> Any:
    """`numpy.linalg.slogdet`."""
    a = np.array(a, QUAD)
    _, sign = _eliminate(a)
    diagonal = np.diagonal(a)
    return np.prod(np.sign(diagonal)) * sign, np.sum(np.log(np.abs(diagonal)))


def cholesky(a: Any) -> Any:
    """`numpy.linalg.cholesky`."""
    a = np.array(a, QUAD)
    made = np.zeros_like(a)
    for j in range(len(a)):
        made[j, j] = np.sqrt(a[j, j] - matmul(made[j, :j], made[j, :j]))
        for i in range(j + 1, len(a)):
            made[i, j] = (a[i, j] - matmul(made[i, :j], made[j, :j])) / made[j, j]
    return made


def qr(a: Any) -> Any:
    """`numpy.linalg.qr`, by orthogonalisation done twice."""
    a = np.array(a, QUAD)
    m = min(a.shape)
    q = np.zeros((a.shape[0], m), QUAD)
    for k in range(m):
        v = a[:, k].copy()
        for _ in range(3):
            v -= matmul(q[:, :k], matmul(q[:, :k].T, v))
        q[:, k] = v / np.sqrt(np.sum(v * v))
    signs = _signs(q, np.linalg.qr(a.astype(float))[0])
    q = q * signs
    return q, np.triu(matmul(q.T, a))


def eigh(a: Any) -> Any:
    """`numpy.linalg.eigh`, by Jacobi's rotations; of a matrix its lower triangle is read."""
    a = np.tril(np.array(a, QUAD))
    a = a + np.tril(a, -1).T
    n, vectors = len(a), _eye(len(a))
    for _ in range(60):
        if np.sum(np.abs(np.tril(a, -1))) <= SMALL * np.sum(np.abs(a)):
            break
        for p in range(n):
            for q in range(p + 1, n):
                if a[p, q] != 0:
                    c, s = _rotation(a[p, p], a[p, q], a[q, q])
                    a[:, p], a[:, q] = c * a[:, p] - s * a[:, q], s * a[:, p] + c * a[:, q]
                    a[p], a[q] = c * a[p] - s * a[q], s * a[p] + c * a[q]
                    vectors[:, p], vectors[:, q] = (c * vectors[:, p] - s * vectors[:, q],
                                                    s * vectors[:, p] + c * vectors[:, q])
    order = np.argsort(np.diagonal(a))
    values, vectors = np.diagonal(a)[order], vectors[:, order]
    return values, vectors


def _rotation(app: Any, apq: Any, aqq: Any) -> tuple[Any, Any]:
    theta = (aqq - app) / (2 * apq)
    t = (1 if theta >= 0 else -1) / (np.abs(theta) + np.sqrt(theta * theta + 1))
    c = 1 / np.sqrt(t * t + 1)
    return c, t * c


def eigh_as_numpy(a: Any) -> Any:
    """`eigh`, each vector with the sign that NumPy's has."""
    values, vectors = eigh(a)
    return values, vectors * _signs(vectors, np.linalg.eigh(np.asarray(a).astype(float))[1])


def svd(a: Any, full_matrices: bool = True, compute_uv: bool = True) -> Any:
    """`numpy.linalg.svd` without the vectors beyond the smaller size: one-sided rotations (G. E. Forsythe, P. Henrici,
    Trans. Amer. Math. Soc. 94, 1960)."""
    a = np.array(a, QUAD)
    if a.shape[0] < a.shape[1]:
        u, s, vt = _svd(a.T.copy())
        u, vt = vt.T, u.T
    else:
        u, s, vt = _svd(a)
    if not compute_uv:
        return s
    signs = _signs(u, np.linalg.svd(a.astype(float), full_matrices=False)[0])
    return u * signs, s, signs[:, None] * vt


def _svd(a: Any) -> Any:
    a, n = a.copy(), a.shape[1]
    v = _eye(n)
    for _ in range(60):
        turned = False
        for p in range(n):
            for q in range(p + 1, n):
                x, y, z = np.sum(a[:, p] ** 2), np.sum(a[:, p] * a[:, q]), np.sum(a[:, q] ** 2)
                if np.abs(y) > SMALL * np.sqrt(x * z):
                    turned = True
                    c, s = _rotation(x, y, z)
                    a[:, p], a[:, q] = c * a[:, p] - s * a[:, q], s * a[:, p] + c * a[:, q]
                    v[:, p], v[:, q] = c * v[:, p] - s * v[:, q], s * v[:, p] + c * v[:, q]
        if not turned:
            break
    sizes = np.sqrt(np.sum(a * a, axis=0))
    order = np.argsort(-sizes)
    return (a / sizes)[:, order], sizes[order], v[:, order].T


def _signs(found: Any, like: Any) -> Any:
    """Of each column the sign that makes it point as the other one does."""
    return np.where(np.sum(found * like.astype(QUAD), axis=0) < 0, -1, 1).astype(QUAD)


def pinv(a: Any) -> Any:
    """`numpy.linalg.pinv` of a matrix of full rank."""
    a = np.array(a, QUAD)
    return solve(matmul(a.T, a), a.T) if a.shape[0] >= a.shape[1] else solve(matmul(a, a.T), a).T


def matrix_power(a: Any, n: int) -> Any:
    """`numpy.linalg.matrix_power`."""
    a, made = (inv(a) if n < 0 else np.array(a, QUAD)), _eye(len(a))
    for _ in range(abs(n)):
        made = made @ a
    return made


def exponential(a: Any) -> Any:
    """The exponential of a matrix: Taylor's series of a part of it, squared."""
    a = np.array(a, QUAD)
    times = max(0, int(np.ceil(np.log2(float(np.max(np.sum(np.abs(a), axis=0))) + 1e-300))) + 4)
    x = a / np.array(2.0 ** times).astype(QUAD)
    term = made = _eye(len(a))
    for k in range(1, 40):
        term = term @ x / np.array(k).astype(QUAD)
        made = made + term
    for _ in range(times):
        made = made @ made
    return made


def lstsq(a: Any, b: Any, rcond: Any = None) -> Any:
    """`numpy.linalg.lstsq` of a matrix of full rank: the solution alone is there."""
    return matmul(pinv(a), b), None, None, None


def sparse_solve(data: Any, rows: Any, columns: Any, b: Any, m: int, n: int, kept: bool) -> Any:
    """`runtime.sparse_solve`, by the matrix with all its elements."""
    full = np.zeros((m, n), QUAD)
    np.add.at(full, (rows, columns), data)
    return solve(full, b)


LINALG = {"solve": solve, "inv": inv, "det": det, "slogdet": slogdet, "cholesky": cholesky, "qr": qr,
          "eigh": eigh_as_numpy, "eigvalsh": lambda a: eigh(a)[0], "svd": svd, "pinv": pinv,
          "matrix_power": matrix_power, "lstsq": lstsq, "LinAlgError": np.linalg.LinAlgError,
          "svdvals": lambda a: svd(a, compute_uv=False)}
RUNTIME = {"exponential": exponential, "sparse_solve": sparse_solve}
