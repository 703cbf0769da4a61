"""Linear systems whose matrix is a function: `product(v, operands)` is the matrix times v, an array of any shape.

Each raises ValueError where it finds no solution; a right-hand side of zeros has zeros.
"""
from __future__ import annotations

import numpy as np


def dense(product, b, operands):
    """The solution of a small system: its matrix is made column by column, and solved with.

    >>> dense(lambda v, operands: operands[0] @ v, np.array([2.0, 4.0]), (np.array([[2.0, 0.0], [1.0, 1.0]]),))
    array([1., 3.])
    """
    if not np.any(b):
        return np.zeros(b.shape, b.dtype)
    matrix = np.empty((b.size, b.size), b.dtype)
    for column in range(b.size):
        unit = np.zeros(b.size, b.dtype)
        unit[column] = 1.0
        matrix[:, column] = product(unit.reshape(b.shape), operands).copy().reshape(b.size)
    return np.linalg.solve(matrix, b.copy().reshape(b.size)).reshape(b.shape)


def cg(product, b, operands):
    """The solution by conjugate gradients (Hestenes and Stiefel, J. Res. NBS 49, 1952): the matrix is symmetric and
    positive definite.

    >>> cg(lambda v, operands: operands[0] @ v, np.array([3.0, 3.0]), (np.array([[2.0, 1.0], [1.0, 2.0]]),))
    array([1., 1.])
    """
    found = np.zeros(b.shape, b.dtype)
    rest, direction = b.copy(), b.copy()
    square = first = np.sum(rest * rest)
    limit = (4.0 * np.finfo(b.dtype).eps) ** 2 * first
    for _ in range(10 * b.size + 10):
        if square <= limit:
            break
        image = product(direction, operands)
        slope = np.sum(direction * image)
        if not slope > 0.0:
            raise ValueError("cg: the matrix is not symmetric and positive definite")
        found += square / slope * direction
        rest -= square / slope * image
        before, square = square, np.sum(rest * rest)
        direction = rest + square / before * direction
    _accept(product, b, operands, found, first)
    return found


def gmres(product, b, operands):
    """The solution by GMRES (Saad and Schultz, SIAM J. Sci. Stat. Comput. 7, 1986), begun anew every 60 steps.

    >>> gmres(lambda v, operands: operands[0] @ v, np.array([2.0, 4.0]), (np.array([[2.0, 0.0], [1.0, 1.0]]),))
    array([1., 3.])
    """
    found = np.zeros(b.shape, b.dtype)
    steps = min(b.size, 60)
    first = np.sum(b * b)
    for _ in range(50):
        rest = b - product(found, operands)
        if np.sum(rest * rest) <= (8.0 * np.finfo(b.dtype).eps) ** 2 * first:
            break
        before = np.sum(rest * rest)
        found = found + _cycle(product, rest, operands, steps)
        rest = b - product(found, operands)
        if not np.sum(rest * rest) < 0.25 * before:
            break
    _accept(product, b, operands, found, first)
    return found


def solved_by(solver, product, b, operands):
    """The solution by a solver of the user's, looked at.

    >>> solved_by(lambda product, b, operands: b / 2.0, lambda v, operands: 2.0 * v, np.array([4.0]), ())
    array([2.])
    """
    found = solver(product, b, operands)
    _accept(product, b, operands, found, np.sum(b * b))
    return found


def _cycle(product, rest, operands, steps):
    """The correction of one round of GMRES."""
    basis = np.zeros((steps + 1, rest.size), rest.dtype)
    projected = np.zeros((steps + 1, steps), rest.dtype)
    start = np.sqrt(np.sum(rest * rest))
    basis[0] = rest.copy().reshape(rest.size) / start
    used = 0
    for step in range(steps):
        image = product(basis[step].copy().reshape(rest.shape), operands).copy().reshape(rest.size)
        size = np.sqrt(np.sum(image * image))
        for _ in range(2):                          # twice is enough: orthogonal to rounding
            for row in range(step + 1):
                part = np.sum(basis[row] * image)
                projected[row, step] += part
                image -= part * basis[row]
        used = step + 1
        norm = np.sqrt(np.sum(image * image))
        projected[step + 1, step] = norm
        if norm <= 8.0 * np.finfo(rest.dtype).eps * size:
            break
        basis[step + 1] = image / norm
    goal = np.zeros(used + 1, rest.dtype)
    goal[0] = start
    weights = np.linalg.lstsq(projected[:used + 1, :used].copy(), goal, float(np.finfo(rest.dtype).eps))[0]
    correction = np.zeros(rest.size, rest.dtype)
    for step in range(used):
        correction += weights[step] * basis[step]
    return correction.reshape(rest.shape)


def _accept(product, b, operands, found, first):
    """Raises unless what was found solves the system."""
    rest = b - product(found, operands)
    if not np.sum(rest * rest) <= 100.0 * np.finfo(b.dtype).eps * first:
        raise ValueError("the linear system of an implicit function's derivative was not solved")
