"""Views that functions make have memory of their own: it is written back where the operand is mentioned, or at the end."""
import numpy as np


def kernel(dy, y, n):
    u, v = y[:n * n].reshape(n, n), y[n * n:].reshape(n, n)
    du, dv = dy[:n * n].reshape(n, n), dy[n * n:].reshape(n, n)
    du[:, 1:] = u[:, 1:] * v[:, :-1]
    for i in range(n):
        for j in range(n):
            dv[i, j] = u[i, j] ** 2 - du[j, i]


ARGUMENTS = (np.zeros(8), np.array([0.7, 1.3, 0.4, 1.1, 1.2, 0.3, 0.9, 0.6]), 2)
WRT, OF = ("y",), ("dy",)
