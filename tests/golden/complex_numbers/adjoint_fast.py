"""Adjoint of kernel: d(psi, return) / d(psi, v, dt).

Engine: Numba. Level: fast. Arguments:
    psi: complex128[:], in-out
    v: float64[:], in
    dt: float64, in

It records:
    psi_here_stack: a part of `psi *= np.exp(-1j * dt * v)`, 16 * psi.shape[0] bytes
"""

# ruff: noqa: FURB136, RUF100

import numpy as np

from s2sad.runtime import added, fft, ifft, sized  # isort: skip


def kernel_adjoint_taped(psi, psi_bar, v, v_bar, dt, result_bar, psi_here_stack):
    """Adjoint of kernel: d(psi, return) / d(psi, v, dt), in given memory."""
    # forward sweep: only what the reverse sweep reads
    assert psi.shape == v.shape, (
        "shapes differ: a length of 1 repeats only where it is "
        "written, as in x[:, None] or x[:1], or an argument's"
    )
    psi_here_stack = sized(psi_here_stack, (psi.shape[0],))
    for i_2 in range(psi.shape[0]):
        psi_here = psi[i_2]
        psi_here_stack[i_2] = psi_here
        psi[i_2] = psi_here * np.exp(-1j * dt * v[i_2])
    psi_next = np.empty_like(psi)
    fft_value = fft(psi, None, -1, None)
    for i_2 in range(psi.shape[0]):
        psi_next[i_2] = fft_value[i_2]
    for i_2 in range(psi.shape[0]):
        psi[i_2] = psi_next[i_2]
    # reverse sweep
    dt_bar = 0.0
    psi_next_bar = np.zeros_like(psi_next)
    # return total
    total_bar = result_bar
    for i in range(psi.size):
        # total += abs(psi[i]) * v[i]
        psi_here = psi[i]
        abs_value = abs(psi_here)
        v_bar[i] += abs_value * total_bar
        psi_bar[i] += np.divide(psi_here * (v[i] * total_bar), 1.0 if abs_value == 0 else abs_value)
    for i_2 in range(psi.shape[0]):
        # psi[:] = np.fft.fft(psi)
        seed = psi_bar[i_2]
        psi_bar[i_2] = 0.0
        psi_next_bar[i_2] += seed
    # psi[:] = np.fft.fft(psi)
    ifft_value = ifft(psi_next_bar, None, -1, "forward")
    for i_2 in range(psi_bar.shape[0]):
        psi_bar[i_2] += ifft_value[i_2]
    for i_2 in range(psi.shape[0]):
        # psi *= np.exp(-1j * dt * v)
        exp_value = np.exp(-1j * dt * v[i_2])
        seed = psi_bar[i_2]
        exp_value_bar = np.conj(psi_here_stack[i_2]) * seed
        seed_2 = np.conj(exp_value) * exp_value_bar if exp_value_bar != 0.0 else 0.0
        dt_bar = added(dt_bar, np.real(1j * (v[i_2] * seed_2)))
        v_bar[i_2] += np.real(1j * dt * seed_2)
        psi_bar[i_2] = np.conj(exp_value) * seed
    return dt_bar, psi_here_stack


def kernel_adjoint(psi, psi_bar, v, v_bar, dt, result_bar):
    returned = kernel_adjoint_taped(
        psi, psi_bar, v, v_bar, dt, result_bar, np.empty(0, np.complex128)
    )
    return (returned[0],)
