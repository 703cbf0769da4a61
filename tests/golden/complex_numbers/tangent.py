"""Tangent of kernel: d(psi, return) / d(psi, v, dt).

Engine: NumPy. Level: plain. Arguments:
    psi: complex128[:], in-out
    v: float64[:], in
    dt: float64, in
"""

# ruff: noqa: FURB136, RUF100

import numpy as np


def kernel_tangent(psi, psi_dot, v, v_dot, dt, dt_dot):
    assert psi.shape == v.shape, (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    slope = np.exp(-1j * dt * v)
    psi_dot[...] = (
        np.where(slope != 0.0, slope * psi_dot, 0.0) - np.where(
            psi != 0.0, psi * np.where(
                v * (1j * dt_dot) + 1j * dt * v_dot != 0.0,
                np.exp(-1j * dt * v) * (v * (1j * dt_dot) + 1j * dt * v_dot), 0.0
            ), 0.0
        )
    )
    psi[...] = psi * np.exp(-1j * dt * v)
    psi_next = np.empty_like(psi)
    psi_next_dot = np.zeros_like(psi_next)
    psi_next[...] = np.fft.fft(psi)
    psi_next_dot[...] = np.fft.fft(psi_dot)
    psi_dot[...] = psi_next_dot
    psi[...] = psi_next
    total_dot = 0.0
    for i in range(psi.size):
        psi_here = psi[i]
        abs_value = abs(psi_here)
        slope_2 = psi_here / (1.0 if abs_value == 0 else abs_value)
        total_dot += (
            (
                v[i] * (np.real(np.conj(slope_2) * psi_dot[i]) if slope_2 != 0.0 else 0.0)
                if v[i] != 0.0 else 0.0
            ) + abs_value * v_dot[i]
        )
    return (total_dot,)
