"""The kernels as one writes them for tangent: plain NumPy without loops over elements, each a sum with its seeds."""
from __future__ import annotations

import inspect
import math

import numpy as np
import tangent

from benchmarks.peers.problems import Problem, Run, Unsupported
from benchmarks.peers.recurrence import ninths



def prepare(variant, kernel, problem: Problem) -> Run:
    """The generated gradient, on fresh copies where the kernel stores into its arguments."""
    if kernel not in KERNELS:
        raise Unsupported("no version of it is written")
    function, wrt = KERNELS[kernel], problem.case.wrt
    names = list(inspect.signature(function).parameters)
    seeds = {f"{name}_seed": seed for name, seed in zip(problem.case.of, problem.seeds)}
    given = {**CONSTANTS, **problem.given, **seeds}
    if kernel == "seidel":
        given["first"], given["matrix"] = ninths(problem.size - 2)
    if kernel == "gmm":
        given["eye"], given["basis"] = factors(given["x"].shape[1])
    gradient = tangent.grad(function, wrt=tuple(names.index(name) for name in wrt))
    stored = STORED.get(kernel, ())

    def call():
        return gradient(*(given[name].copy() if name in stored else given[name] for name in names))

    return Run(call, lambda found: list(found) if isinstance(found, tuple) else [found])


def factors(d):
    """The unit matrix, and for each element below the diagonal, column by column, the matrix that has a 1 there."""
    columns, rows = np.triu_indices(d, 1)
    basis = np.zeros((rows.size, d, d))
    basis[np.arange(rows.size), rows, columns] = 1.0
    return np.eye(d), basis


def brusselator(u, p, t, du_seed):
    a = p[0]
    b = p[1]
    alpha = p[2]
    dx = p[3]
    n = du_seed.shape[0]
    x = np.arange(n) * dx
    inside = (x[:, None] - 0.3) ** 2 + (x[None, :] - 0.6) ** 2 <= 0.01
    forcing = np.where(inside, 5.0, 0.0) if t >= 1.1 else np.zeros((n, n))
    neighbours = np.roll(u, 1, 0) + np.roll(u, -1, 0) + np.roll(u, 1, 1) + np.roll(u, -1, 1)
    diffusion = alpha / dx ** 2 * (neighbours - 4.0 * u)
    first = u[:, :, 0]
    second = u[:, :, 1]
    reaction = first ** 2 * second
    du0 = diffusion[:, :, 0] + b + reaction - (a + 1.0) * first + forcing
    du1 = diffusion[:, :, 1] + a * first - reaction
    return np.sum(du0 * du_seed[:, :, 0]) + np.sum(du1 * du_seed[:, :, 1])


def integrate(u, p, dt, steps):
    a = p[0]
    b = p[1]
    dx = p[3]
    alpha = p[2] / dx ** 2
    first = u[:, :, 0]
    second = u[:, :, 1]
    for _ in range(steps):
        reaction = first ** 2 * second
        around = np.roll(first, 1, 0) + np.roll(first, -1, 0) + np.roll(first, 1, 1) + np.roll(first, -1, 1)
        beside = np.roll(second, 1, 0) + np.roll(second, -1, 0) + np.roll(second, 1, 1) + np.roll(second, -1, 1)
        change = alpha * (around - 4.0 * first) + b + reaction - (a + 1.0) * first
        second = second + dt * (alpha * (beside - 4.0 * second) + a * first - reaction)
        first = first + dt * change
    return 0.5 * (np.sum(first ** 2) + np.sum(second ** 2))


def jacobi(a, b, steps, a_seed):
    for _ in range(steps):
        b[1:-1, 1:-1] = 0.2 * (a[1:-1, 1:-1] + a[1:-1, :-2] + a[1:-1, 2:] + a[2:, 1:-1] + a[:-2, 1:-1])
        a[1:-1, 1:-1] = 0.2 * (b[1:-1, 1:-1] + b[1:-1, :-2] + b[1:-1, 2:] + b[2:, 1:-1] + b[:-2, 1:-1])
    return np.sum(a * a_seed)


def seidel(a, steps, first, matrix):
    for _ in range(steps):
        for i in range(1, matrix.shape[0] + 1):
            above = a[i - 1, :-2] + a[i - 1, 1:-1] + a[i - 1, 2:]
            old = above + a[i, 1:-1] + a[i, 2:] + a[i + 1, :-2] + a[i + 1, 1:-1] + a[i + 1, 2:]
            a[i, 1:-1] = a[i, 0] * first + np.dot(old, matrix)
    return 0.5 * np.sum(a ** 2)


def advect(u, c, steps, u_seed):
    for _ in range(steps):
        left = u - np.roll(u, 1)
        right = np.roll(u, -1) - u
        least = np.where(np.abs(left) < np.abs(right), left, right)
        slope = np.where(left * right <= 0.0, 0.0, least)
        flux = c * (u + 0.5 * (1.0 - c) * slope)
        u = u - (flux - np.roll(flux, 1))
    return np.sum(u * u_seed)


def mixture(alphas, means, scales, x):
    z = np.exp(scales) * (x[:, None, :] - means)
    term = alphas + np.sum(scales, axis=1) - 0.5 * np.sum(z ** 2, axis=2)
    top = np.max(term, axis=1, keepdims=True)
    total = np.sum(top) + np.sum(np.log(np.sum(np.exp(term - top), axis=1)))
    largest = np.max(alphas)
    return total - x.shape[0] * (largest + np.log(np.sum(np.exp(alphas - largest))))


def nbody(position, velocity, mass, dt, steps, softening, position_seed):
    for _ in range(steps):
        apart = position[None, :, :] - position[:, None, :]
        inverse = (np.sum(apart ** 2, axis=2) + softening * softening) ** -1.5
        weight = mass * inverse
        velocity = velocity + dt * np.sum(weight[:, :, None] * apart, axis=1)
        position = position + dt * velocity
    return np.sum(0.5 * mass * np.sum(velocity ** 2, axis=1)) + np.sum(position * position_seed)


def glacier(thickness, bed, rate, balance, dx, dt, steps, thickness_seed):
    factor = 2.0 * rate * (917.0 * 9.81) ** 3 / 5.0
    for _ in range(steps):
        surface = bed + thickness
        slope_x = (surface[1:, :] - surface[:-1, :]) / dx
        slope_y = (surface[:, 1:] - surface[:, :-1]) / dx
        along = 0.5 * (slope_x[:, 1:] + slope_x[:, :-1])
        across = 0.5 * (slope_y[1:, :] + slope_y[:-1, :])
        steep = np.sqrt(along ** 2 + across ** 2)
        mean = 0.25 * (thickness[:-1, :-1] + thickness[1:, :-1] + thickness[:-1, 1:] + thickness[1:, 1:])
        diffusivity = mean ** 5 * steep ** 2 * factor
        flux_x = -0.5 * (diffusivity[:, 1:] + diffusivity[:, :-1]) * slope_x[:, 1:-1]
        flux_y = -0.5 * (diffusivity[1:, :] + diffusivity[:-1, :]) * slope_y[1:-1, :]
        change = (flux_x[1:, :] - flux_x[:-1, :]) / dx + (flux_y[:, 1:] - flux_y[:, :-1]) / dx
        inner = thickness[1:-1, 1:-1] + dt * (balance - change)
        thickness[1:-1, 1:-1] = np.where(inner > 0.0, inner, 0.0)
    return np.sum(thickness * thickness_seed)


def lattice(f, omega, steps, cx, cy, weight, f_seed):
    for _ in range(steps):
        for q in range(9):
            f[q] = np.roll(np.roll(f[q], cx[q], axis=0), cy[q], axis=1)
        rho = np.sum(f, axis=0)
        ux = np.sum(f * cx[:, None, None], axis=0) / rho
        uy = np.sum(f * cy[:, None, None], axis=0) / rho
        still = 1.5 * (ux ** 2 + uy ** 2)
        for q in range(9):
            cu = 3.0 * (cx[q] * ux + cy[q] * uy)
            f[q] = f[q] + omega * (rho * weight[q] * (1.0 + cu + 0.5 * cu ** 2 - still) - f[q])
    return np.sum(f * f_seed)


def attention(q, k, v, out_seed):
    score = np.dot(q, np.transpose(k)) * (1.0 / np.sqrt(out_seed.shape[1]))
    weight = np.exp(score - np.max(score, axis=1, keepdims=True))
    share = 1.0 / np.sum(weight, axis=1)
    return np.sum(np.dot(weight, v) * share[:, None] * out_seed)


CONSTANTS = {"cx": np.array([0, 1, 0, -1, 0, 1, -1, -1, 1]), "cy": np.array([0, 0, 1, 0, -1, 1, 1, -1, -1]),
             "weight": np.array([4 / 9] + [1 / 9] * 4 + [1 / 36] * 4)}
def gmm(alpha, mu, q, l, x, gamma, m, sign, eye, basis):  # noqa: E741
    d = x.shape[1]
    parts = np.exp(q)[:, :, None] * eye + np.sum(l[:, :, None, None] * basis, axis=1)
    y = np.sum(parts[None, :, :, :] * (x[:, None, :] - mu)[:, :, None, :], axis=3)
    terms = alpha + np.sum(q, axis=1) - 0.5 * np.sum(y ** 2, axis=2)
    top = np.max(terms, axis=1, keepdims=True)
    total = np.sum(top) + np.sum(np.log(np.sum(np.exp(terms - top), axis=1)))
    largest = np.max(alpha)
    weights = largest + np.log(np.sum(np.exp(alpha - largest)))
    likelihood = total - x.shape[0] * (0.5 * d * math.log(2.0 * math.pi) + weights)
    # the constant of the prior has no derivative
    return likelihood + sign * (-0.5 * gamma * gamma * np.sum(parts ** 2) + m * np.sum(q))


def lstm(main_params, extra_params, state, sequence):
    b = sequence.shape[1]
    total = 0.0
    first = state[0]
    memory = state[1]
    second = state[2]
    store = state[3]
    for t in range(sequence.shape[0] - 1):
        x = sequence[t] * extra_params[0]
        gates = main_params[0]
        bias = main_params[1]
        forget = 1.0 / (1.0 + np.exp(-(x * gates[:b] + bias[:b])))
        ingate = 1.0 / (1.0 + np.exp(-(first * gates[b:2 * b] + bias[b:2 * b])))
        outgate = 1.0 / (1.0 + np.exp(-(x * gates[2 * b:3 * b] + bias[2 * b:3 * b])))
        memory = memory * forget + ingate * np.tanh(first * gates[3 * b:] + bias[3 * b:])
        first = outgate * np.tanh(memory)
        gates = main_params[2]
        bias = main_params[3]
        forget = 1.0 / (1.0 + np.exp(-(first * gates[:b] + bias[:b])))
        ingate = 1.0 / (1.0 + np.exp(-(second * gates[b:2 * b] + bias[b:2 * b])))
        outgate = 1.0 / (1.0 + np.exp(-(first * gates[2 * b:3 * b] + bias[2 * b:3 * b])))
        store = store * forget + ingate * np.tanh(second * gates[3 * b:] + bias[3 * b:])
        second = outgate * np.tanh(store)
        x = second * extra_params[1] + extra_params[2]
        total = total + np.sum(sequence[t + 1] * (x - np.log(2.0 + np.sum(np.exp(x)))))
    return -total / (b * (sequence.shape[0] - 1))


KERNELS = {f.__name__: f for f in (
    brusselator, integrate, jacobi, seidel, advect, mixture, nbody, glacier, lattice, attention, gmm,
    lstm)}
STORED = {"jacobi": ("a", "b"), "seidel": ("a",), "glacier": ("thickness",), "lattice": ("f",)}
