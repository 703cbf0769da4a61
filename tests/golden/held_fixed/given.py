"""wrt without p: no line is about p's adjoint."""
import numpy as np


def kernel(du, u, p):
    rate = p[0] / p[1]
    for i in range(u.size):
        du[i] = rate * u[i] * u[i] + p[1] * rate


ARGUMENTS = (np.zeros(2), np.array([0.7, -1.3]), np.array([1.2, 0.8]))
WRT, OF = ("u",), ("du",)
