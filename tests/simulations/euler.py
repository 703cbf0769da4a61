"""The Euler equations in one dimension: MUSCL with a van Leer limiter, HLL fluxes, Heun's method."""
import numpy as np

GAMMA = 1.4


def primitive(q):
    rho = q[0]
    u = q[1] / rho
    p = (GAMMA - 1.0) * (q[2] - 0.5 * rho * u ** 2)
    return rho, u, p


def flux(rho, u, p):
    f = np.empty((3, rho.size))
    f[0] = rho * u
    f[1] = rho * u ** 2 + p
    f[2] = u * (p / (GAMMA - 1.0) + 0.5 * rho * u ** 2 + p)
    return f


def limited(q):
    """Slopes of the cells between others."""
    left = q[:, 1:-1] - q[:, :-2]
    right = q[:, 2:] - q[:, 1:-1]
    product = left * right
    return np.where(product > 0.0, 2.0 * product / (left + right + 1e-30), 0.0)


def hll(left, right):
    rho_l, u_l, p_l = primitive(left)
    rho_r, u_r, p_r = primitive(right)
    c_l, c_r = np.sqrt(GAMMA * p_l / rho_l), np.sqrt(GAMMA * p_r / rho_r)
    slow = np.minimum(np.minimum(u_l - c_l, u_r - c_r), 0.0)
    fast = np.maximum(np.maximum(u_l + c_l, u_r + c_r), 0.0)
    f_l, f_r = flux(rho_l, u_l, p_l), flux(rho_r, u_r, p_r)
    return (fast * f_l - slow * f_r + slow * fast * (right - left)) / (fast - slow)


def rate(q, dx):
    padded = np.empty((3, q.shape[1] + 4))
    padded[:, 2:-2] = q
    padded[:, :2] = q[:, :1]
    padded[:, -2:] = q[:, -1:]
    slope = limited(padded)
    centre = padded[:, 1:-1]
    f = hll(centre[:, :-1] + 0.5 * slope[:, :-1], centre[:, 1:] - 0.5 * slope[:, 1:])
    return -(f[:, 1:] - f[:, :-1]) / dx


def euler(q, dx, dt, steps):
    """Density, momentum and energy advanced in place."""
    for _ in range(steps):
        first = q + dt * rate(q, dx)
        q[:] = 0.5 * (q + first + dt * rate(first, dx))
