"""The kernels as one writes them for MyGrad: tensors, stores in place, `backward`."""
from __future__ import annotations

import math

import mygrad as mg
import numpy as np

from benchmarks.gradbench.kernels.gmm import log_multigamma
from benchmarks.peers.problems import Problem, Run, Unsupported
from benchmarks.peers.recurrence import ninths



def prepare(variant, kernel, problem: Problem) -> Run:
    """Forward and backward, which fills the tensors' gradients."""
    if kernel not in KERNELS:
        raise Unsupported("no version of it is written")
    function, wrt, seeds = KERNELS[kernel], problem.case.wrt, problem.seeds
    given = problem.taken(function)
    values = [given.pop(name) for name in wrt]

    def gradient():
        inputs = [mg.tensor(value, dtype=float, copy=False) for value in values]
        found = function(**given, **dict(zip(wrt, inputs)))
        outputs = found if isinstance(found, tuple) else (found,)
        sum(mg.sum(output * seed) for output, seed in zip(outputs, seeds)).backward()
        return [one.grad for one in inputs]

    return Run(gradient, list)


def brusselator(u, p, t):
    a, b, alpha, dx = p
    n = u.shape[0]
    x = np.arange(n) * dx.data
    inside = (x[:, None] - 0.3) ** 2 + (x[None, :] - 0.6) ** 2 <= 0.01
    forcing = np.where(inside & (t >= 1.1), 5.0, 0.0)
    neighbours = mg.roll(u, 1, 0) + mg.roll(u, -1, 0) + mg.roll(u, 1, 1) + mg.roll(u, -1, 1)
    diffusion = alpha / dx ** 2 * (neighbours - 4.0 * u)
    first, second = u[:, :, 0], u[:, :, 1]
    reaction = first ** 2 * second
    return diffusion + mg.stack([b + reaction - (a + 1.0) * first + forcing, a * first - reaction], axis=2)


def integrate(u, p, dt, steps):
    for s in range(steps):
        u = u + dt * brusselator(u, p, s * dt)
    return 0.5 * mg.sum(u ** 2)


def averaged(a):
    return 0.2 * (a[1:-1, 1:-1] + a[1:-1, :-2] + a[1:-1, 2:] + a[2:, 1:-1] + a[:-2, 1:-1])


def jacobi(a, b, steps):
    a, b = +a, +b
    for _ in range(steps):
        b[1:-1, 1:-1] = averaged(a)
        a[1:-1, 1:-1] = averaged(b)
    return a


def seidel(a, steps):
    first, matrix = ninths(a.shape[0] - 2)
    a = +a
    for _ in range(steps):
        for i in range(1, a.shape[0] - 1):
            above, here, below = a[i - 1], a[i], a[i + 1]
            old = (above[:-2] + above[1:-1] + above[2:] + here[1:-1] + here[2:] + below[:-2] + below[1:-1] + below[2:])
            a[i, 1:-1] = here[0] * first + mg.matmul(old, matrix)
    return 0.5 * mg.sum(a ** 2)


def minmod(a, b):
    return mg.where((a * b).data <= 0.0, 0.0, mg.where(np.abs(a.data) < np.abs(b.data), a, b))


def advect(u, c, steps):
    for _ in range(steps):
        flux = c * (u + 0.5 * (1.0 - c) * minmod(u - mg.roll(u, 1), mg.roll(u, -1) - u))
        u = u - (flux - mg.roll(flux, 1))
    return u


def log_sum_exp(values):
    top = mg.max(values, axis=-1, keepdims=True)
    return top[..., 0] + mg.log(mg.sum(mg.exp(values - top), axis=-1))


def mixture(alphas, means, scales, x):
    z = mg.exp(scales) * (x[:, None, :] - means)
    term = alphas + mg.sum(scales, axis=1) - 0.5 * mg.sum(z ** 2, axis=2)
    return mg.sum(log_sum_exp(term)) - x.shape[0] * log_sum_exp(alphas)


def nbody(position, velocity, mass, dt, steps, softening):
    for _ in range(steps):
        apart = position[None, :, :] - position[:, None, :]
        inverse = (mg.sum(apart ** 2, axis=2) + softening * softening) ** -1.5
        velocity = velocity + dt * mg.sum((mass * inverse)[:, :, None] * apart, axis=1)
        position = position + dt * velocity
    return mg.sum(0.5 * mass * mg.sum(velocity ** 2, axis=1)), position


def glacier(thickness, bed, rate, balance, dx, dt, steps):
    thickness = +thickness
    factor = 2.0 * rate * (917.0 * 9.81) ** 3 / 5.0
    for _ in range(steps):
        surface = bed + thickness
        slope_x = (surface[1:, :] - surface[:-1, :]) / dx
        slope_y = (surface[:, 1:] - surface[:, :-1]) / dx
        steep = mg.sqrt((0.5 * (slope_x[:, 1:] + slope_x[:, :-1])) ** 2
                        + (0.5 * (slope_y[1:, :] + slope_y[:-1, :])) ** 2)
        mean = 0.25 * (thickness[:-1, :-1] + thickness[1:, :-1] + thickness[:-1, 1:] + thickness[1:, 1:])
        diffusivity = factor * mean ** 5 * steep ** 2
        flux_x = -0.5 * (diffusivity[:, 1:] + diffusivity[:, :-1]) * slope_x[:, 1:-1]
        flux_y = -0.5 * (diffusivity[1:, :] + diffusivity[:-1, :]) * slope_y[1:-1, :]
        change = (flux_x[1:, :] - flux_x[:-1, :]) / dx + (flux_y[:, 1:] - flux_y[:, :-1]) / dx
        thickness[1:-1, 1:-1] = mg.maximum(thickness[1:-1, 1:-1] + dt * (balance - change), 0.0)
    return thickness


def lattice(f, omega, steps):
    cx = np.array([0, 1, 0, -1, 0, 1, -1, -1, 1])
    cy = np.array([0, 0, 1, 0, -1, 1, 1, -1, -1])
    weight = np.array([4 / 9] + [1 / 9] * 4 + [1 / 36] * 4)[:, None, None]
    for _ in range(steps):
        f = mg.stack([mg.roll(mg.roll(f[q], cx[q], axis=0), cy[q], axis=1) for q in range(9)])
        rho = mg.sum(f, axis=0)
        ux = mg.sum(f * cx[:, None, None], axis=0) / rho
        uy = mg.sum(f * cy[:, None, None], axis=0) / rho
        cu = 3.0 * (cx[:, None, None] * ux + cy[:, None, None] * uy)
        f = f + omega * (rho * weight * (1.0 + cu + 0.5 * cu ** 2 - 1.5 * (ux ** 2 + uy ** 2)) - f)
    return f


def attention(q, k, v):
    score = mg.matmul(q, k.T) * (1.0 / np.sqrt(q.shape[1]))
    weight = mg.exp(score - mg.max(score, axis=1, keepdims=True))
    return mg.matmul(weight / mg.sum(weight, axis=1, keepdims=True), v)


def gmm(alpha, mu, q, l, x, gamma, m, sign):  # noqa: E741
    n, d = x.shape
    columns, rows = np.triu_indices(d, 1)
    factor = mg.exp(q)[:, :, None] * np.eye(d)
    factor[:, rows, columns] = l
    y = mg.einsum("kij,nkj->nki", factor, x[:, None, :] - mu)
    terms = alpha + mg.sum(q, axis=1) - 0.5 * mg.sum(y ** 2, axis=2)
    likelihood = mg.sum(log_sum_exp(terms)) - n * (0.5 * d * math.log(2.0 * math.pi) + log_sum_exp(alpha))
    freedom = d + m + 1
    constant = freedom * d * (math.log(gamma) - 0.5 * math.log(2.0)) - log_multigamma(0.5 * freedom, d)
    squares = mg.sum(factor ** 2)
    prior = alpha.shape[0] * constant - 0.5 * gamma * gamma * squares + m * mg.sum(q)
    return likelihood + sign * prior


def sigmoid(x):
    return 1.0 / (1.0 + mg.exp(-x))


def layer(weight, bias, hidden, cell, x):
    b = x.shape[0]
    forget = sigmoid(x * weight[:b] + bias[:b])
    ingate = sigmoid(hidden * weight[b:2 * b] + bias[b:2 * b])
    outgate = sigmoid(x * weight[2 * b:3 * b] + bias[2 * b:3 * b])
    cell = cell * forget + ingate * mg.tanh(hidden * weight[3 * b:] + bias[3 * b:])
    return outgate * mg.tanh(cell), cell


def lstm(main_params, extra_params, state, sequence):
    c, b = sequence.shape
    state = list(state)
    total = 0.0
    for t in range(c - 1):
        x = sequence[t] * extra_params[0]
        for k in range(0, len(state), 2):
            state[k], state[k + 1] = layer(main_params[k], main_params[k + 1], state[k], state[k + 1], x)
            x = state[k]
        x = x * extra_params[1] + extra_params[2]
        total = total + mg.sum(sequence[t + 1] * (x - mg.log(2.0 + mg.sum(mg.exp(x)))))
    return -total / (b * (c - 1))


KERNELS = {f.__name__: f for f in (
    brusselator, integrate, jacobi, seidel, advect, mixture, nbody, glacier, lattice, attention, gmm,
    lstm)}
