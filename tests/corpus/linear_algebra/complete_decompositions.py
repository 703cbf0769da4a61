"""Complete decompositions where they are the reduced ones, condition numbers, norms of matrices in two axes, and
products of arrays of any ranks."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case, outputs
from tests.harness.seeds import generator

_NEW = np.lib.NumpyVersion(np.__version__) >= "2.2.0"


# -- a, b: stacks of two 3 x 3, x: 3; what is returned is a number --------------------------------------------------

def all_vectors(a, b, x):
    u, s, vt = np.linalg.svd(a[0])
    v = np.linalg.svd(a, full_matrices=True)[2]
    left, _, right = np.linalg.svd(b[1, :2])
    return np.sum((u[:, 0] * s) @ vt) + np.sum(v[:, 0] ** 2 @ x) + np.sum(left ** 3)


def of_tall_matrices(a, b, x):
    """What a principal component analysis reads."""
    u, s, vt = np.linalg.svd(np.concatenate((a[0], b[0])))
    q, r = np.linalg.qr(a[0, :2], mode="complete")
    return np.sum(vt[:2] ** 2 @ x) + np.sum(s) + np.sum(q ** 3) + np.sum(r @ x)


def orthogonal(a, b, x):
    q, r = np.linalg.qr(a[1], "complete")
    p = np.linalg.qr(b, "reduced")[0]
    return np.sum(q ** 3 @ x) + np.sum(r ** 2) + np.sum(p[:, 0] @ x)


def conditions(a, b, x):
    c = np.linalg.cond(a[0]) + np.linalg.cond(a[0], 1) + np.linalg.cond(a[1], p=np.inf) + np.linalg.cond(b[0], "fro")
    c += np.linalg.cond(b[0, :2]) * np.linalg.cond(b[1], -2) + np.linalg.cond(b[1], -1) + np.linalg.cond(b[1], "nuc")
    return c * x[0] + np.sum(np.linalg.cond(a) * x[:2]) + np.sum(np.linalg.cond(b, 1) * x[1:])


def norms_in_two_axes(a, b, x):
    s = np.linalg.norm(a, 1, axis=(1, 2)) + np.linalg.norm(a, 2, axis=(-2, -1)) + np.linalg.norm(b, "nuc", (1, 2))
    s *= np.linalg.norm(b, np.inf, axis=(2, 1)) + np.linalg.norm(b, -2, axis=(1, 2)) + np.linalg.norm(b, axis=(1, 2))
    across = np.linalg.norm(b, 1, axis=(0, 2)) + np.linalg.norm(a, -np.inf, (1, 0)) + np.linalg.norm(a, 2, axis=(0, 2))
    return s[0] * s[1] + across @ x + np.linalg.norm(a[0], 1, axis=(1, 0)) * np.linalg.norm(b[0], -1, axis=(0, 1))


def dots(a, b, x):
    c = np.dot(a, b)
    y = a.dot(b[0]) * np.dot(a[0], b)[:, 0] + np.inner(a, b[1]) + np.dot(c[0, :, 1], x)
    b[...] = y * b
    return np.sum(c * c) + np.sum(np.inner(a, b) ** 2) + np.sum(np.inner(x, a) ** 2) + np.sum(np.inner(b, x) ** 2)


def blocks(a, b, x):
    c = np.kron(x, b[0]) * 2.0
    d = np.kron(a[0], x)
    return np.sum(c[1] ** 2) + np.sum(d[:, 4] ** 3) + np.sum(np.kron(a, b[0, :2])[1] ** 2) + np.sum(
        np.kron(x, b)[0, 1] ** 2)


def under_other_names(a, b, x):
    b *= np.linalg.outer(x, x) + np.linalg.matmul(a[0], b) + np.outer(a[0], x)[:3]
    s = np.linalg.trace(a[0]) + np.sum(np.linalg.diagonal(a[0], offset=1)) + np.sum(np.linalg.svdvals(b[0]) * x)
    s += np.sum(np.linalg.cross(a[0], x) ** 2) + np.sum(np.linalg.tensordot(a, b, axes=((1, 2), (2, 1))))
    return s + np.sum(np.vecdot(a, b) ** 2) + np.linalg.vecdot(x, x) + np.sum(np.linalg.vecdot(a, x)) + np.sum(
        np.linalg.matrix_norm(b) * x[:2]) + np.linalg.matrix_norm(a[0], ord=1)


def arguments(n=3):
    random = generator(4)
    a, b = random.random((2, 2, n, n))
    return a + np.diag(2.0 + np.arange(n)), b + np.diag(3.0 + 2.0 * np.arange(n)), 0.5 + random.random(n)


def left_of_tall(a):
    return np.sum(np.linalg.svd(a[:, :2])[0] ** 3)


def right_of_wide(a):
    return np.sum(np.linalg.svd(a[:2])[2] ** 3)


def complete_and_tall(a):
    return np.sum(np.linalg.qr(a[:, :2], mode="complete")[0] ** 3)


def of_eight_axes(a):
    return np.sum(np.dot(a[None, None], a[None, None]) ** 2)


def of_eight_axes_in_pairs(a):
    return np.sum(np.inner(a[None, None], a[None, None]) ** 2)


def in_the_middle_mode(a):
    return np.sum(np.linalg.qr(a, mode="raw")[0])


def complex_products(z, w):
    return np.sum(np.abs(np.dot(z, w)) ** 2) + np.sum(np.abs(np.inner(z, w[0])) ** 2)


def of_short_axes(a, b, x):
    return np.sum(np.dot(a, b) ** 2) + np.sum(np.inner(a, a[0]) ** 2) + np.sum(np.kron(x, a[0]))


def cases():
    a, b, _ = arguments()
    for kernel in (all_vectors, dots, of_tall_matrices, orthogonal, conditions, norms_in_two_axes, blocks,
                   *([under_other_names] if _NEW else [])):
        yield Case(kernel, arguments(), ("a", "b", "x"), outputs(kernel, arguments()))
    # single precision
    for kernel in (all_vectors, dots, norms_in_two_axes):
        given = tuple(g.astype(np.float32) for g in arguments())
        yield Case(kernel, given, ("a", "b", "x"), outputs(kernel, given))
    yield Case(complex_products, (a + 1j * b, b - 0.5j * a), ("z", "w"))
    # short axes
    for m, n in ((0, 2), (1, 2), (2, 0)):
        yield Case(of_short_axes, (np.ones((2, m, n)), np.ones((3, n, m)), np.ones(m)), ("a", "b", "x"))
    # vectors that are not determined
    for kernel, refused in (
            (left_of_tall,
             "S501 at `np.linalg.svd(a[:, :2])`: more singular vectors than the smaller size of the matrix are not "
             "determined: a.shape[0] is 3, min(2, a.shape[1]) is 2: pass full_matrices=False"),
            (right_of_wide,
             "S501 at `np.linalg.svd(a[:2])`: more singular vectors than the smaller size of the matrix are not "
             "determined: a.shape[1] is 3, min(2, a.shape[0]) is 2: pass full_matrices=False"),
            (complete_and_tall,
             'S501 at `np.linalg.qr(a[:, :2], mode="complete")`: more columns of q than the smaller size of the '
             "matrix are not determined: a.shape[0] is 3, min(2, a.shape[1]) is 2: pass mode='reduced'")):
        yield Case(kernel, (np.eye(3),), refused=refused)
    yield Case(in_the_middle_mode, (np.eye(3),), of=None, refused=(
        'S301 at `np.linalg.qr(a, mode="raw")`: no derivative rule for numpy.linalg.qr: write q, r = '
        "np.linalg.qr(a), in the reduced mode"))
    # results of six axes
    for kernel in (of_eight_axes, of_eight_axes_in_pairs):
        yield Case(kernel, (np.eye(3) + np.arange(9.0).reshape(3, 3) / 10.0,), "a")
