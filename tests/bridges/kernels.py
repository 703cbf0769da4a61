"""Kernels that other packages call: a stencil in place, numbers, several outputs, what reads by index, what raises."""
import numpy as np

TABLE = np.array([1.0, 2.0, 3.0, 4.0])


def relax(u, rate):
    for i in range(1, u.size - 1):
        u[i] += rate * (0.5 * (u[i - 1] + u[i + 1]) - u[i])


def energy(u, w):
    total = 0.0
    for i in range(1, u.size):
        total += w * (u[i] - u[i - 1]) ** 2 + u[i] ** 3
    return total


def several(u, out, c, mode="plain", nothing=None):
    for i in range(u.size):
        out[i] = c * u[i] * u[i]
    if mode == "shifted":
        out[0] += 1.0
    return u[0] * c, np.sqrt(u[1:]), 3


def root(x):
    if x < 0.0:
        raise ValueError("a root of less than zero")
    return x ** 0.5


def pick(u, i):
    return u[i] * u[i]


def gathered(u, index):
    total = 0.0
    for k in range(index.size):
        total += u[index[k]] ** 2
    return total


def weighted(u):
    total = 0.0
    for i in range(u.size):
        total += TABLE[i] * u[i] ** 2
    return total


def made(u, n):
    return np.zeros(n) + u[0]


def positive(u):
    found = []
    for i in range(u.size):
        if u[i] > 0.0:
            found.append(u[i])
    return np.array(found)


def rotated(z, c):
    for i in range(z.size):
        z[i] = c * z[i] * z[i]
    return z[0] * (1.0 + 2.0j)


def halved(u):
    for i in range(u.size):
        u[i] = u[i] * np.float32(0.5)


def applied(g, x):
    return g(x) * x


def turned(x):
    out = np.empty((x.shape[1], x.shape[0]))
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            out[j, i] = x[i, j] ** 2 * (i + 1)
    return out


def squared(x):
    return np.sum(x * x)
