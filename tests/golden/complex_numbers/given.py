"""Complex numbers, and a transform: what is real and meets them gains the real part."""
import numpy as np


def kernel(psi, v, dt):
    psi *= np.exp(-1j * dt * v)
    psi[:] = np.fft.fft(psi)
    total = 0.0
    for i in range(psi.size):
        total += abs(psi[i]) * v[i]
    return total


ARGUMENTS = (np.array([0.2 + 0.5j, 0.3 - 0.1j, -0.4j]), np.array([0.7, -1.3, 0.4]), 0.5)
WRT, OF = ("psi", "v", "dt"), ("psi", "return")
