"""Functions of whole arrays with options and operands as they are often written."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

U = np.array([[0.3, 0.9, 0.7, 0.8], [0.5, 0.2, 0.6, 0.4], [0.15, 0.25, 0.35, 0.45], [0.55, 0.65, 0.75, 0.85]])
POINTS = np.array([0.0, 0.1, 0.25, 0.7])


def blocks_of_vectors(u):
    return np.sum(np.kron(u[0], np.array([1.0, 2.0, 3.0])) ** 2) + np.sum(np.kron(u[:2], u[2:, 1:] + 1.0) ** 2)


def products_of_stacks(u):
    stack = np.stack([u, u ** 2])
    return np.sum(np.dot(stack, u[0]) ** 2) + np.sum(np.dot(u, [1.0, 2.0, 0.5, 3.0]) ** 2)


def written_operands(u):
    smooth = np.convolve(u[0], [0.2, 0.5, 0.3], mode="same")
    return (np.sum(smooth ** 2) + np.dot([1.0, 2.0, 0.5, 3.0], u[0]) + np.interp(u[1, 1], [0.0, 1.0, 2.0], u[2][:3])
            + np.sum(([1.0, 2.0, 3.0, 4.0] @ u) ** 2) * np.polyval([1.0, 0.5], u[0, 0]))


def ends_of_gradients(u):
    total = np.sum(np.gradient(u[0], 0.1, edge_order=2) ** 2) + np.sum(np.gradient(u[1], POINTS, edge_order=2) ** 3)
    a, b = np.gradient(u, 0.1, edge_order=2)
    return total + np.sum(a * b) + np.sum(np.gradient(u, POINTS, axis=1, edge_order=2) ** 2)


def ends_of_tables(u):
    v = np.interp(u[0], np.array([0.31, 0.5, 0.85]), u[1, :3], left=-1.0, right=u[3, 3])
    return np.sum(v ** 2) + np.interp(u[2, 0], np.array([0.1, 0.2]), u[3, :2], left=7.0) + np.interp(
        1.0, np.array([0.0, 1.0]), u[3, :2], right=7.0) + np.interp(2.0, np.array([0.0, 1.0]), u[3, :2], right=u[0, 0])


def means_without_nans(u):
    v = u.copy()
    v[1, 2] = np.nan
    return np.nanmean(v ** 2) + np.sum(np.nanmean(v, axis=0) ** 2) + np.sum(np.nanmean(v, axis=1, keepdims=True) * u)


def open_axes(u):
    stack = np.stack([u, u ** 2])
    rows = np.einsum("...i,...i->...", stack, stack)
    turned = np.einsum("...i, ij -> ...j", stack, u)
    return np.sum(rows ** 2) + np.sum(turned ** 2) + np.sum(np.einsum("...i,i", u, u[0])) + np.einsum(
        "...i,...i->...", u[0], u[1])


def products_with_numbers(u):
    return np.sum(np.dot(0, 3) + u[0]) + np.dot(u[0, 0], u[0, 1]) + np.sum(np.dot(u, 2)) * np.dot(2, u[1, 1])


def ranges_as_operands(u):
    x, y = np.meshgrid(range(4), range(4))
    inside = (x - 1) ** 2 + y ** 2 < 3
    u[inside] = u[inside] ** 2
    a, b = np.meshgrid([1.0, 2.0, 0.5, 3.0], u[0], indexing="ij")
    return np.sum(u * x) + np.sum(a * b) + np.dot(u[1], range(4))


def cases():
    # derivatives
    for kernel in (open_axes, blocks_of_vectors, products_of_stacks, written_operands, ends_of_gradients,
            ends_of_tables, means_without_nans, products_with_numbers, ranges_as_operands):
        yield Case(kernel, (U,), ("u",))
