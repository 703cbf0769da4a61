"""Grids that are not taken apart where they are made: one array of all axes, or a list of an array for each."""
import numpy as np

from tests.corpus import Case


def array_of_grids(x, y):
    grid = np.array(np.meshgrid(x, y))
    return np.sum(grid ** 2 * np.array(np.meshgrid(x, y, indexing="xy"))[::-1])


def stacked_grids(x, y):
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    deep = np.dstack(np.meshgrid(x, y))
    return np.sum(grid[..., 0] * grid[..., 1] ** 2) + np.sum(deep[:, :, 0] ** 2 * deep[..., 1])


def points_of_a_grid(x, y):
    points = np.column_stack([g.ravel() for g in np.meshgrid(x, y)])
    rows = np.vstack(list(map(np.ravel, np.meshgrid(*[x, y], indexing="ij"))))
    return np.sum(points[:, 0] * points[:, 1] ** 2) + np.sum(rows[0] * rows[1] ** 3)


def one_of_a_list_is_written(x, y):
    grids = np.meshgrid(x, y)
    first, second = grids
    first *= 2.0
    grids[1][0, 1] = y[0] ** 2
    return np.sum(grids[0] * grids[1] ** 2) + np.sum(first * second)


def starred_grids(x, y):
    a, b, c = np.meshgrid(x, y, [0.1, 0.2], indexing="ij")
    return np.sum(np.hypot(*np.meshgrid(x, y))) + np.sum(a * b * c)


def open_grids(x, y):
    a, b = np.meshgrid(x, y, sparse=True)
    c, d = np.meshgrid(x, y, indexing="ij", sparse=True)
    a[0, 0] = y[0]
    return np.sum(a * b ** 2) + np.sum(c ** 2 * d)


def grid_in_a_loop(x, y):
    total = 0.0
    for k in range(3):
        grid = np.array(np.meshgrid(x + k, y * k))
        x[0] += 0.1 * grid[0].sum()
        total += np.sum(grid[1] * grid[0])
    return total


def array_of_slices(x, y):
    grid = np.mgrid[0:3, 0:2] * x[0]
    grid[0] += y[0]
    points = np.mgrid[0:2, 0:3].reshape(2, -1).T * x[1]
    return np.sum(grid ** 2) + np.sum(points[:, 0] * points[:, 1]) + np.sum(np.mgrid[0:2, 0:3][::-1] * x[2])


def parts_of_an_array(x, y):
    grid = np.mgrid[-1:1:3j, 0:2:2j]
    a, b = grid
    a *= x[0]
    return np.sum(grid[0] ** 2) + np.sum(grid[1] * y[0] * b)


def cases():
    x, y = np.array([0.3, 0.7, -0.4]), np.array([1.1, 0.6])
    for kernel in (array_of_grids, stacked_grids, points_of_a_grid, one_of_a_list_is_written, starred_grids, open_grids,
                   grid_in_a_loop, array_of_slices, parts_of_an_array):
        yield Case(kernel, (x, y), ("x", "y"))
