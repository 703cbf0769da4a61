"""Flow past an obstacle by lattice Boltzmann, D2Q9, with bounce-back and an inflow."""
import numpy as np

C = np.array([[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]])
W = np.array([4.0 / 9.0] + [1.0 / 9.0] * 4 + [1.0 / 36.0] * 4)
OPPOSITE = np.array([0, 3, 4, 1, 2, 7, 8, 5, 6])


def equilibrium(rho, ux, uy):
    feq = np.empty((9, rho.shape[0], rho.shape[1]))
    square = 1.5 * (ux ** 2 + uy ** 2)
    for i in range(9):
        cu = 3.0 * (C[i, 0] * ux + C[i, 1] * uy)
        feq[i] = W[i] * rho * (1.0 + cu + 0.5 * cu ** 2 - square)
    return feq


def lattice_boltzmann(f, omega, inflow, solid, steps):
    """Populations advanced in place; returns the drag's impulse in the direction of the flow."""
    impulse = 0.0
    for _ in range(steps):
        rho = np.sum(f, axis=0)
        ux = (f[1] + f[5] + f[8] - f[3] - f[6] - f[7]) / rho
        uy = (f[2] + f[5] + f[6] - f[4] - f[7] - f[8]) / rho
        ux[0, 1:-1] = inflow
        out = f - omega * (f - equilibrium(rho, ux, uy))
        for i in range(9):
            out[i, solid] = f[OPPOSITE[i], solid]
            impulse += C[i, 0] * np.sum(f[i, solid])
        for i in range(9):
            f[i] = np.roll(np.roll(out[i], C[i, 0], axis=0), C[i, 1], axis=1)
    return impulse
