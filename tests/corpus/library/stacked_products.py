"""Products of arrays of more than two axes: one matrix for all of a stack, two stacks, and sums over several axes."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def one_matrix_for_a_stack(x, w):
    y = x @ w
    x[...] = y[:, :, :4] * x
    y *= 0.5
    w += 0.1 * np.sum(y, axis=(0, 1))
    return np.sum(y ** 2) + np.sum(x @ w[:, 0])


def a_stack_for_one_matrix(x, w):
    y = np.matmul(w.T, np.swapaxes(x, 1, 2))
    x *= 2.0
    return np.sum(y ** 3) + np.sum(w[:3, 1] @ x[:, :3, 0].T)


def a_row_for_a_stack(x, w):
    v = w[0, :3] @ x
    x[0] = 0.0
    return np.sum(v ** 2)


def stacks_in_a_loop(x, w):
    y = np.zeros((2, 3, 3))
    for k in range(3):
        y[...] = y @ (x @ np.transpose(x, (0, 2, 1))) + k
        x *= 0.9
        x[k % 2] = y[k % 2] @ x[k % 2]
    return np.sum(y) * w[0, 0]


def attention_heads(x, w):
    rows, columns = x.shape[1], w.shape[1]
    q = (x @ w).reshape(2, rows, 2, columns // 2).transpose(0, 2, 1, 3)
    scores = q @ q.transpose(0, 1, 3, 2)
    shares = np.exp(scores - np.max(scores, axis=-1, keepdims=True))
    shares /= np.sum(shares, axis=-1, keepdims=True)
    y = (shares @ q).transpose(0, 2, 1, 3).reshape(2, rows, columns)
    return np.sum(y ** 2)


def stacks_of_stacks(x, w):
    left = np.stack([x, 0.5 * x])[:, :, None] * np.ones((1, 1, 2, 1, 1))
    right = np.swapaxes(left, -1, -2)
    products = left @ right
    left[0] = np.sin(left[1])
    return np.sum(products ** 2) + np.sum((left @ right)[:, ::-1] * products) + np.sum(w)


def over_two_axes(x, w):
    full = np.tensordot(x, x[:, :2], axes=([0, 2], [0, 2])) @ w[:2]
    x[1] = full[:, :4] * x[0]
    return np.sum(full ** 2) + np.sum(np.tensordot(w, x, axes=([0], [2])) ** 2) + np.sum(np.tensordot(x, x[0]) ** 2)


def named_axes(x, w):
    heads = np.stack([x, 2.0 * x], axis=1)
    scores = np.einsum("bhqd,bhkd->bhqk", heads, heads)
    x[...] = np.einsum("bhqk,bhkd->bqd", scores, heads)
    moved = np.einsum("bij,jk->kbi", x, w)
    w *= 0.1
    return np.sum(moved ** 2) + np.sum(np.einsum("bij,bkj,kl->il", x, x, x[0, :, :2]) ** 2) + np.sum(
        np.einsum("bij,bij->b", x, x) ** 2)


def repeated_matrices(x, w):
    single = x[:1]
    y = single @ np.transpose(x, (0, 2, 1)) + np.einsum("bij,bkj->bik", x, single)
    x[0] = y[0] @ x[1]
    return np.sum(y ** 2) + np.sum(x) + np.sum(np.einsum("bij,jk->bik", x[:, :, :1], w) ** 2)


def of_whole_numbers(x, k):
    y = k @ k[0].T
    k += 1
    return np.sum(x[:, :, :3] * y * (k @ np.swapaxes(k, 1, 2)))


def cases():
    r = generator(11)
    x, w = r.standard_normal((2, 3, 4)), r.standard_normal((4, 6))
    kernels = [one_matrix_for_a_stack, a_stack_for_one_matrix, a_row_for_a_stack, stacks_in_a_loop, attention_heads,
               stacks_of_stacks, over_two_axes, named_axes, repeated_matrices]
    for kernel in kernels:
        yield Case(kernel, (x, w), ("x", "w"))
    # other arrays
    large = 0.1 * r.standard_normal((2, 9, 12)), 0.1 * r.standard_normal((12, 14))
    for kernel in [attention_heads, named_axes, stacks_in_a_loop, one_matrix_for_a_stack]:
        yield Case(kernel, (x.astype(np.float32), w.astype(np.float32)), ("x", "w"))
        yield Case(kernel, (x[:, ::-1], np.asfortranarray(w)), ("x", "w"))
    for kernel in [attention_heads, named_axes, a_stack_for_one_matrix]:
        yield Case(kernel, large, ("x", "w"))
    for kernel in [named_axes, over_two_axes, one_matrix_for_a_stack]:
        yield Case(kernel, (x + 0.5j * x[::-1], w.astype(complex)), ("x", "w"))
    yield Case(a_stack_for_one_matrix, (x, 1.0j * w), ("x", "w"))
    # no matrices, and no columns
    yield Case(a_stack_for_one_matrix, (x[:0], w), "w")
    yield Case(stacks_in_a_loop, (x[:, :, :0], w), "w")
    # integers
    yield Case(of_whole_numbers, (x, np.arange(24).reshape(2, 3, 4)), ("x",))
