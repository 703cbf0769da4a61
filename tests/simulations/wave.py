"""The scalar wave equation, second order in time, with a sponge and a source, recorded at receivers."""
import numpy as np


def laplacian(p, dx):
    out = np.zeros_like(p)
    out[1:-1, 1:-1] = (p[2:, 1:-1] + p[:-2, 1:-1] + p[1:-1, 2:] + p[1:-1, :-2] - 4.0 * p[1:-1, 1:-1]) / dx ** 2
    return out


def ricker(t, peak):
    a = (np.pi * peak * (t - 1.0 / peak)) ** 2
    return (1.0 - 2.0 * a) * np.exp(-a)


def sponge(n, width, strength):
    distance = np.minimum(np.arange(n), np.arange(n)[::-1])
    return np.where(distance < width, np.exp(-strength * (width - distance) ** 2), 1.0)


def wave(c, observed, source, receivers, dt=0.02, dx=0.1, peak=5.0):
    """Misfit of a seismogram to what was observed, for a velocity model."""
    n = c.shape[0]
    damp = sponge(n, 2, 0.1)[:, None] * sponge(n, 2, 0.1)
    old, now = np.zeros_like(c), np.zeros_like(c)
    seismogram = np.zeros_like(observed)
    for step in range(observed.shape[0]):
        new = 2.0 * now - old + (c * dt) ** 2 * laplacian(now, dx)
        new[source[0], source[1]] += dt ** 2 * ricker(step * dt, peak)
        new *= damp
        now *= damp
        old, now = now, new
        seismogram[step] = now[1, receivers]
    residual = seismogram - observed
    return 0.5 * np.sum(residual ** 2) / dt ** 4
