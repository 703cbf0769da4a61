"""Adjoint of kernel: d(psi, return) / d(psi, v, dt).

Engine: NumPy. Level: plain. Arguments:
    psi: complex128[:], in-out
    v: float64[:], in
    dt: float64, in

It records:
    psi_before: psi before `psi *= np.exp(-1j * dt * v)`, 16 * psi.size bytes
    psi_before_2: psi before `psi[:] = np.fft.fft(psi)`, 16 * psi.size bytes
"""

# ruff: noqa: FURB136, RUF100

import numpy as np


def kernel_adjoint(psi, psi_bar, v, v_bar, dt, result_bar):
    # forward sweep: only what the reverse sweep reads
    assert psi.shape == v.shape, (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    psi_before = np.copy(psi)
    psi[...] = psi * np.exp(-1j * dt * v)
    psi_next = np.empty_like(psi)
    psi_next[...] = np.fft.fft(psi)
    psi[...] = psi_next
    # reverse sweep
    psi_next_bar = np.zeros_like(psi_next)
    # return total
    total_bar = result_bar
    for i in range(psi.size - 1, -1, -1):
        # total += abs(psi[i]) * v[i]
        psi_here = psi[i]
        abs_value = abs(psi_here)
        v_bar[i] += abs_value * total_bar
        psi_bar[i] += psi_here * (v[i] * total_bar) / (1.0 if abs_value == 0 else abs_value)
    # psi[:] = np.fft.fft(psi)
    seed = np.copy(psi_bar)
    psi_next_bar[...] += seed
    psi_bar[...] = np.fft.ifft(psi_next_bar, axis=-1, norm="forward")
    # psi *= np.exp(-1j * dt * v)
    psi[...] = psi_before
    seed_3 = np.copy(psi_bar)
    seed_4 = np.conj(psi) * seed_3
    exp_value = np.exp(-1j * dt * v)
    seed_5 = np.where(seed_4 != 0.0, np.conj(exp_value) * seed_4, 0.0)
    psi_bar[...] = np.conj(exp_value) * seed_3
    dt_bar = np.sum(np.real(1j * (v * seed_5)))
    v_bar[...] += np.real(1j * dt * seed_5)
    return (dt_bar,)
