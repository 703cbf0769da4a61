"""Normal form."""

import numpy as np


def kernel(psi, v, dt):
    assert psi.shape == v.shape, (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    psi[...] = psi * np.exp(-1j * dt * v)
    psi_next = np.empty_like(psi)
    psi_next[...] = np.fft.fft(psi)
    psi[...] = psi_next
    total = 0.0
    total_1 = total
    for i in range(psi.size):
        psi_here = psi[i]
        abs_value = abs(psi_here)
        total_1 += abs_value * v[i]
    return total_1
