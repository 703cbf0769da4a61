"""The kernels as one writes them for HIPS autograd: its NumPy, whole arrays without stores, loops over the steps."""
from __future__ import annotations

import math

import autograd
import autograd.numpy as np

from benchmarks.gradbench.kernels.gmm import log_multigamma
from benchmarks.peers.problems import Problem, Run, Unsupported
from benchmarks.peers.recurrence import ninths



def prepare(variant, kernel, problem: Problem) -> Run:
    """The gradient of the seeded sum of the outputs."""
    if kernel not in KERNELS:
        raise Unsupported("no version of it is written")
    function, wrt, seeds = KERNELS[kernel], problem.case.wrt, problem.seeds
    given = problem.taken(function)
    inputs = [given.pop(name) for name in wrt]

    def loss(*inputs):
        found = function(**given, **dict(zip(wrt, inputs)))
        outputs = found if isinstance(found, tuple) else (found,)
        return sum(np.sum(output * seed) for output, seed in zip(outputs, seeds))

    gradient = autograd.grad(loss, tuple(range(len(wrt))))
    return Run(lambda: gradient(*inputs), list)


def brusselator(u, p, t):
    a, b, alpha, dx = p
    n = u.shape[0]
    x = np.arange(n) * dx
    inside = (x[:, None] - 0.3) ** 2 + (x[None, :] - 0.6) ** 2 <= 0.01
    forcing = np.where(inside & (t >= 1.1), 5.0, 0.0)
    neighbours = np.roll(u, 1, 0) + np.roll(u, -1, 0) + np.roll(u, 1, 1) + np.roll(u, -1, 1)
    diffusion = alpha / dx ** 2 * (neighbours - 4.0 * u)
    first, second = u[:, :, 0], u[:, :, 1]
    reaction = first ** 2 * second
    return diffusion + np.stack([b + reaction - (a + 1.0) * first + forcing, a * first - reaction], axis=2)


def integrate(u, p, dt, steps):
    for s in range(steps):
        u = u + dt * brusselator(u, p, s * dt)
    return 0.5 * np.sum(u ** 2)


def averaged(a):
    return 0.2 * (a[1:-1, 1:-1] + a[1:-1, :-2] + a[1:-1, 2:] + a[2:, 1:-1] + a[:-2, 1:-1])


def framed(a, inner):
    middle = np.concatenate([a[1:-1, :1], inner, a[1:-1, -1:]], axis=1)
    return np.concatenate([a[:1], middle, a[-1:]], axis=0)


def jacobi(a, b, steps):
    for _ in range(steps):
        b = framed(b, averaged(a))
        a = framed(a, averaged(b))
    return a


def seidel(a, steps):
    first, matrix = ninths(a.shape[0] - 2)
    rows = [a[i] for i in range(a.shape[0])]
    for _ in range(steps):
        for i in range(1, len(rows) - 1):
            above, here, below = rows[i - 1], rows[i], rows[i + 1]
            old = (above[:-2] + above[1:-1] + above[2:] + here[1:-1] + here[2:] + below[:-2] + below[1:-1] + below[2:])
            rows[i] = np.concatenate([here[:1], here[0] * first + np.dot(old, matrix), here[-1:]])
    return 0.5 * sum(np.sum(row ** 2) for row in rows)


def minmod(a, b):
    return np.where(a * b <= 0.0, 0.0, np.where(np.abs(a) < np.abs(b), a, b))


def advect(u, c, steps):
    for _ in range(steps):
        flux = c * (u + 0.5 * (1.0 - c) * minmod(u - np.roll(u, 1), np.roll(u, -1) - u))
        u = u - (flux - np.roll(flux, 1))
    return u


def log_sum_exp(values):
    top = np.max(values, axis=-1, keepdims=True)
    return top[..., 0] + np.log(np.sum(np.exp(values - top), axis=-1))


def mixture(alphas, means, scales, x):
    z = np.exp(scales) * (x[:, None, :] - means)
    term = alphas + np.sum(scales, axis=1) - 0.5 * np.sum(z ** 2, axis=2)
    return np.sum(log_sum_exp(term)) - x.shape[0] * log_sum_exp(alphas)


def nbody(position, velocity, mass, dt, steps, softening):
    for _ in range(steps):
        apart = position[None, :, :] - position[:, None, :]
        inverse = (np.sum(apart ** 2, axis=2) + softening * softening) ** -1.5
        velocity = velocity + dt * np.sum((mass * inverse)[:, :, None] * apart, axis=1)
        position = position + dt * velocity
    return np.sum(0.5 * mass * np.sum(velocity ** 2, axis=1)), position


def glacier(thickness, bed, rate, balance, dx, dt, steps):
    factor = 2.0 * rate * (917.0 * 9.81) ** 3 / 5.0
    for _ in range(steps):
        surface = bed + thickness
        slope_x = (surface[1:, :] - surface[:-1, :]) / dx
        slope_y = (surface[:, 1:] - surface[:, :-1]) / dx
        steep = np.sqrt((0.5 * (slope_x[:, 1:] + slope_x[:, :-1])) ** 2
                        + (0.5 * (slope_y[1:, :] + slope_y[:-1, :])) ** 2)
        mean = 0.25 * (thickness[:-1, :-1] + thickness[1:, :-1] + thickness[:-1, 1:] + thickness[1:, 1:])
        diffusivity = factor * mean ** 5 * steep ** 2
        flux_x = -0.5 * (diffusivity[:, 1:] + diffusivity[:, :-1]) * slope_x[:, 1:-1]
        flux_y = -0.5 * (diffusivity[1:, :] + diffusivity[:-1, :]) * slope_y[1:-1, :]
        change = (flux_x[1:, :] - flux_x[:-1, :]) / dx + (flux_y[:, 1:] - flux_y[:, :-1]) / dx
        thickness = framed(thickness, np.maximum(thickness[1:-1, 1:-1] + dt * (balance - change), 0.0))
    return thickness


def lattice(f, omega, steps):
    cx = np.array([0, 1, 0, -1, 0, 1, -1, -1, 1])
    cy = np.array([0, 0, 1, 0, -1, 1, 1, -1, -1])
    weight = np.array([4 / 9] + [1 / 9] * 4 + [1 / 36] * 4)[:, None, None]
    for _ in range(steps):
        f = np.stack([np.roll(np.roll(f[q], cx[q], axis=0), cy[q], axis=1) for q in range(9)])
        rho = np.sum(f, axis=0)
        ux = np.sum(f * cx[:, None, None], axis=0) / rho
        uy = np.sum(f * cy[:, None, None], axis=0) / rho
        cu = 3.0 * (cx[:, None, None] * ux + cy[:, None, None] * uy)
        f = f + omega * (rho * weight * (1.0 + cu + 0.5 * cu ** 2 - 1.5 * (ux ** 2 + uy ** 2)) - f)
    return f


def attention(q, k, v):
    score = np.dot(q, k.T) * (1.0 / np.sqrt(q.shape[1]))
    weight = np.exp(score - np.max(score, axis=1, keepdims=True))
    return np.dot(weight / np.sum(weight, axis=1, keepdims=True), v)


def gmm(alpha, mu, q, l, x, gamma, m, sign):  # noqa: E741
    n, d = x.shape
    columns, rows = np.triu_indices(d, 1)
    basis = np.zeros((rows.size, d, d))
    basis[np.arange(rows.size), rows, columns] = 1.0
    factor = np.exp(q)[:, :, None] * np.eye(d) + np.tensordot(l, basis, 1)
    y = np.einsum("kij,nkj->nki", factor, x[:, None, :] - mu)
    terms = alpha + np.sum(q, axis=1) - 0.5 * np.sum(y ** 2, axis=2)
    likelihood = np.sum(log_sum_exp(terms)) - n * (0.5 * d * math.log(2.0 * math.pi) + log_sum_exp(alpha))
    freedom = d + m + 1
    constant = freedom * d * (math.log(gamma) - 0.5 * math.log(2.0)) - log_multigamma(0.5 * freedom, d)
    squares = np.sum(factor ** 2)
    prior = alpha.shape[0] * constant - 0.5 * gamma * gamma * squares + m * np.sum(q)
    return likelihood + sign * prior


def sigmoid(x):
    return 1.0 / (1.0 + np.exp(-x))


def layer(weight, bias, hidden, cell, x):
    b = x.shape[0]
    forget = sigmoid(x * weight[:b] + bias[:b])
    ingate = sigmoid(hidden * weight[b:2 * b] + bias[b:2 * b])
    outgate = sigmoid(x * weight[2 * b:3 * b] + bias[2 * b:3 * b])
    cell = cell * forget + ingate * np.tanh(hidden * weight[3 * b:] + bias[3 * b:])
    return outgate * np.tanh(cell), cell


def lstm(main_params, extra_params, state, sequence):
    c, b = sequence.shape
    state = [state[k] for k in range(state.shape[0])]
    total = 0.0
    for t in range(c - 1):
        x = sequence[t] * extra_params[0]
        for k in range(0, len(state), 2):
            state[k], state[k + 1] = layer(main_params[k], main_params[k + 1], state[k], state[k + 1], x)
            x = state[k]
        x = x * extra_params[1] + extra_params[2]
        total = total + np.sum(sequence[t + 1] * (x - np.log(2.0 + np.sum(np.exp(x)))))
    return -total / (b * (c - 1))


KERNELS = {f.__name__: f for f in (
    brusselator, integrate, jacobi, seidel, advect, mixture, nbody, glacier, lattice, attention, gmm,
    lstm)}
