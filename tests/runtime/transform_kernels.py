"""Kernels that transform, for tests/runtime/test_transforms.py."""
import numpy as np


def heat(u, nu, dt, steps):
    """A pseudo-spectral step of the heat equation in a loop."""
    n = u.size
    k = np.fft.fftfreq(n, 1.0 / n)
    for _ in range(steps):
        u_hat = np.fft.fft(u)
        u_hat *= np.exp(-nu * k ** 2 * dt)
        u[:] = np.fft.ifft(u_hat).real
    return np.sum(u ** 3)


def burgers(u, dt, length):
    """A spectral derivative of real values, in a loop over time."""
    k = 2.0 * np.pi * np.fft.rfftfreq(u.size, length / u.size)
    for _ in range(3):
        slope = np.fft.irfft(1j * k * np.fft.rfft(u), n=u.size)
        u -= dt * u * slope
    return np.mean(u ** 2)


def split_step(psi, v, w, dt):
    """Schroedinger's equation, a half step of the potential at a time."""
    k = np.fft.fftfreq(psi.size) * 2.0 * np.pi
    for _ in range(2):
        psi *= np.exp(-0.5j * dt * v)
        psi[:] = np.fft.ifft(np.exp(-0.5j * dt * k ** 2) * np.fft.fft(psi))
        psi *= np.exp(-0.5j * dt * v)
    return np.sum(np.abs(psi) ** 2 * w)


def poisson(f, phi):
    """Poisson's equation on a torus; the mean is set to zero."""
    n, m = f.shape
    kx, ky = np.fft.fftfreq(n, 1.0 / n), np.fft.fftfreq(m, 1.0 / m)
    k2 = kx[:, None] ** 2 + ky[None, :] ** 2
    k2[0, 0] = 1.0
    f_hat = np.fft.fft2(f)
    f_hat /= -k2
    f_hat[0, 0] = 0.0
    phi[:, :] = np.fft.ifft2(f_hat).real


def lengths(x, z):
    """Every transform along one axis, longer and shorter than its operand, in each norm."""
    a = np.fft.fft(x, 7, norm="ortho")
    b = np.fft.fft(z, n=3, norm="forward")
    c = np.fft.ifft(z, 6)
    d = np.fft.rfft(x, 7) + np.fft.rfft(x, n=6, norm="ortho")
    e = np.fft.rfft(x[:3], norm="forward")
    f = np.fft.irfft(z) * np.fft.irfft(z, 6, norm="forward")
    g = np.fft.irfft(z, n=7, norm="ortho") + np.fft.irfft(x, 7)
    h = np.sum(a * a) + np.sum(b ** 3) + np.sum(c * c)
    return h + np.sum(d ** 2 * d) + np.sum(e * e), np.sum(f), np.sum(g ** 2)


def several_axes(x, z):
    """Transforms along several axes, and along one of several."""
    a = np.fft.fft(x, axis=0) * np.fft.ifft(z, axis=1)
    b = np.fft.fftn(x) + np.fft.ifftn(z, norm="forward") + np.fft.fftn(z, axes=(0,)) + np.fft.ifft2(x, norm="ortho")
    c = np.fft.rfft2(x)
    d = np.fft.irfft2(c * c, s=(3, 4)) + np.fft.irfftn(np.fft.rfftn(x) * 1j, (3, 4), axes=(0, 1), norm="ortho")
    e = np.fft.rfft(x, axis=0)
    f = np.fft.irfft(e * e, 3, axis=0)
    return np.sum(a * a * b) + np.sum(np.fft.fft2(z, s=(2, 5)) ** 2), np.sum(d * d * f)


def shifts(x, z):
    """Shifts, as even and odd lengths need them."""
    a = np.fft.fftshift(x) * np.fft.ifftshift(z.real)
    b = np.fft.ifftshift(z, axes=1) * np.fft.fftshift(z * x, axes=(0,))
    return np.sum(a * b)
