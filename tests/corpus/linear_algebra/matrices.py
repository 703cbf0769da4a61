"""Linear algebra of whole matrices."""
from __future__ import annotations

import numpy as np

from s2sad.runtime import cofactors
from tests.corpus import Case, outputs
from tests.harness.seeds import generator


def inverted(a, b, x):
    b[...] = np.linalg.inv(a) * b
    return np.sum(np.linalg.inv(b) * a)


def determinant(a, b, x):
    x *= np.linalg.det(a)
    return np.linalg.det(a * b) * x[0]


def log_determinant(a, b, x):
    x *= np.linalg.slogdet(a)[1]
    sign, logdet = np.linalg.slogdet(a @ b)
    return sign * logdet * x[1]


def lower_triangle(a, b, x):
    lower = np.linalg.cholesky(a)
    b[...] = lower * b
    return np.sum(np.linalg.cholesky(a)[1] * x)


def solved(a, b, x):
    x[:] = np.linalg.solve(a, x)
    b[...] = np.linalg.solve(a, b)
    return np.sum(np.linalg.solve(b, x))


def eigenvalues(a, b, x):
    x *= np.linalg.eigvalsh(a)
    w, v = np.linalg.eigh(a)
    b[...] = b * v ** 2 * w
    return np.sum(np.linalg.eigh(a)[0] * x)


def singular(a, b, x):
    s = np.linalg.svd(b, compute_uv=False)
    x *= s
    return np.sum(s ** 3) + np.sum(np.linalg.svd(a[:2])[1] * x[:2])


def pseudoinverse(a, b, x):
    b[...] = np.linalg.pinv(b) * a
    return np.sum(np.linalg.pinv(a[:2]) * b[:, 1:]) + np.sum(np.linalg.pinv(a[:, 1:]) * b[1:])


def least(a, b, x):
    y = np.linalg.lstsq(a[:, :2], x, rcond=None)[0]
    z = np.linalg.lstsq(a[:2], b[:2], rcond=None)[0]
    solution, residuals, rank, values = np.linalg.lstsq(a, b, None)
    return np.sum(y ** 2) + np.sum(z ** 3) + np.sum(solution * b)


def powers(a, b, x):
    b[...] = np.linalg.matrix_power(a, 3) * b + np.linalg.matrix_power(a, -2)
    return np.sum(np.linalg.matrix_power(b, 0) * a + np.linalg.matrix_power(b, 1) * a)


def in_a_loop(a, b, x):
    for k in range(3):
        a[k, k] += x[k] ** 2
        x[:] = np.linalg.solve(a, x) + np.linalg.inv(a) @ x
        a *= np.log(np.linalg.det(a)) / 3.0


def summed_by_letters(a, b, x):
    b[...] = np.einsum("ij,kj->ik", a, b) * np.einsum("ij->ji", a) + np.einsum("i,j", x, x)
    x *= np.einsum("ij,ij->i", a, b) + np.einsum("ji,j->i", b, x) + np.einsum("ij->j", a)
    return np.einsum("ij,i,j->", a, x, x) + np.einsum("ij,jk,kl->il", a, b, a)[1, 2]


def stacks_of_matrices(a, b, x):
    c = np.einsum("i,jk->ijk", x, a)
    d = np.matmul(c, b)
    e = d @ c
    b[...] = b + np.einsum("bij,bjk->ik", e, c) + (e @ x)
    return np.sum(e * d) + np.sum(x @ e)


def tensors(a, b, x):
    c = np.tensordot(a, x, 0)
    b *= np.tensordot(c, b, axes=([0, 1], [0, 1])) + np.tensordot(a, b, axes=1)
    return np.tensordot(a, b, 2) + np.sum(np.tensordot(a, b, axes=(0, 1)) * a)


def blocks(a, b, x):
    c = np.kron(a, b)
    c *= np.kron(b, b)
    y = np.kron(x, x)
    b *= c[3:6, 2:5]
    return np.sum(c * c) + np.sum(y[1:8] ** 3) + c[0, 8]


def arguments():
    random = generator(5)
    a = random.random((3, 3))
    return a @ a.T + np.diag([1.0, 2.0, 3.5]), 0.5 + random.random((3, 3)) + np.eye(3), 0.5 + random.random(3)


def stack(a):
    return np.sum(np.linalg.lstsq(a[None], a, rcond=None)[0])


def factors_of(a):
    return np.sum(np.linalg.qr(a, mode="raw")[0])


def singular_vectors(a):
    return np.sum(np.linalg.svd(a, full_matrices=True, compute_uv=True)[0])


def part_of_a_derivative(a):
    return np.sum(cofactors(a))


def cases():
    for kernel in (inverted, determinant, log_determinant, lower_triangle, solved, eigenvalues, singular, pseudoinverse,
                   least, powers, in_a_loop, tensors, blocks, summed_by_letters, stacks_of_matrices):
        yield Case(kernel, arguments(), ("a", "b", "x"), outputs(kernel, arguments()))
    for kernel, refused in (
            (stack,
             "S301 at `np.sum(np.linalg.lstsq(a[None], a, rcond=None)[0])`: no derivative rule for numpy.sum of "
             "unknown: write a loop that adds the elements"),
            (factors_of,
             'S301 at `np.linalg.qr(a, mode="raw")`: no derivative rule for numpy.linalg.qr: write q, r = '
             "np.linalg.qr(a), in the reduced mode"),
            (singular_vectors,
             "S301 at `np.linalg.svd(a, full_matrices=True, compute_uv=True)`: no derivative rule for "
             "numpy.linalg.svd: write full_matrices=False: the vectors beyond the smaller size are not determined"),
            (part_of_a_derivative,
             "S301 at `cofactors(a)`: no derivative rule for runtime.cofactors: write it with functions that have a "
             "rule, or give it one: s2sad.rule, s2sad.nondifferentiable")):
        yield Case(kernel, (np.eye(2),), refused=refused)
