"""The kernels as one writes them for PyTorch: tensors, stores into clones, loops over the steps."""
from __future__ import annotations

import math

import numpy as np
import torch

from benchmarks.gradbench.kernels.gmm import log_multigamma
from benchmarks.peers.problems import Problem, Run, Unsupported
from benchmarks.peers.recurrence import ninths

torch.set_num_threads(1)


def prepare(variant, kernel, problem: Problem) -> Run:
    """Forward and backward on tensors of float64."""
    if kernel not in KERNELS:
        raise Unsupported("no version of it is written")
    function, wrt = KERNELS[kernel], problem.case.wrt
    given = {n: torch.from_numpy(v) if isinstance(v, np.ndarray) else v for n, v in problem.taken(function).items()}
    inputs = [torch.as_tensor(given.pop(n), dtype=torch.float64).requires_grad_() for n in wrt]
    seeds = [torch.as_tensor(seed, dtype=torch.float64) for seed in problem.seeds]

    def gradient():
        found = function(**given, **dict(zip(wrt, inputs)))
        return torch.autograd.grad(found, inputs, seeds)

    return Run(gradient, lambda found: [g.numpy() for g in found])


def brusselator(u, p, t):
    a, b, alpha, dx = p
    n = u.shape[0]
    x = torch.arange(n) * dx
    inside = (x[:, None] - 0.3) ** 2 + (x[None, :] - 0.6) ** 2 <= 0.01
    forcing = torch.where(inside & (t >= 1.1), 5.0, 0.0)
    neighbours = torch.roll(u, 1, 0) + torch.roll(u, -1, 0) + torch.roll(u, 1, 1) + torch.roll(u, -1, 1)
    diffusion = alpha / dx ** 2 * (neighbours - 4.0 * u)
    first, second = u[:, :, 0], u[:, :, 1]
    reaction = first ** 2 * second
    return diffusion + torch.stack([b + reaction - (a + 1.0) * first + forcing, a * first - reaction], dim=2)


def integrate(u, p, dt, steps):
    for s in range(steps):
        u = u + dt * brusselator(u, p, s * dt)
    return 0.5 * torch.sum(u ** 2)


def averaged(a):
    return 0.2 * (a[1:-1, 1:-1] + a[1:-1, :-2] + a[1:-1, 2:] + a[2:, 1:-1] + a[:-2, 1:-1])


def jacobi(a, b, steps):
    a, b = a.clone(), b.clone()
    for _ in range(steps):
        b[1:-1, 1:-1] = averaged(a)
        a[1:-1, 1:-1] = averaged(b)
    return a


def seidel(a, steps):
    first, matrix = map(torch.from_numpy, ninths(a.shape[0] - 2))
    rows = list(a)
    for _ in range(steps):
        for i in range(1, len(rows) - 1):
            above, here, below = rows[i - 1], rows[i], rows[i + 1]
            old = (above[:-2] + above[1:-1] + above[2:] + here[1:-1] + here[2:] + below[:-2] + below[1:-1] + below[2:])
            rows[i] = torch.cat([here[:1], here[0] * first + old @ matrix, here[-1:]])
    return 0.5 * torch.sum(torch.stack(rows) ** 2)


def minmod(a, b):
    return torch.where(a * b <= 0.0, 0.0, torch.where(torch.abs(a) < torch.abs(b), a, b))


def advect(u, c, steps):
    for _ in range(steps):
        flux = c * (u + 0.5 * (1.0 - c) * minmod(u - torch.roll(u, 1), torch.roll(u, -1) - u))
        u = u - (flux - torch.roll(flux, 1))
    return u


def mixture(alphas, means, scales, x):
    z = torch.exp(scales) * (x[:, None, :] - means)
    term = alphas + torch.sum(scales, dim=1) - 0.5 * torch.sum(z ** 2, dim=2)
    return torch.sum(torch.logsumexp(term, dim=1)) - x.shape[0] * torch.logsumexp(alphas, dim=0)


def nbody(position, velocity, mass, dt, steps, softening):
    for _ in range(steps):
        apart = position[None, :, :] - position[:, None, :]
        inverse = (torch.sum(apart ** 2, dim=2) + softening * softening) ** -1.5
        velocity = velocity + dt * torch.sum((mass * inverse)[:, :, None] * apart, dim=1)
        position = position + dt * velocity
    return torch.sum(0.5 * mass * torch.sum(velocity ** 2, dim=1)), position


def glacier(thickness, bed, rate, balance, dx, dt, steps):
    factor = 2.0 * rate * (917.0 * 9.81) ** 3 / 5.0
    for _ in range(steps):
        surface = bed + thickness
        slope_x = (surface[1:, :] - surface[:-1, :]) / dx
        slope_y = (surface[:, 1:] - surface[:, :-1]) / dx
        steep = torch.sqrt((0.5 * (slope_x[:, 1:] + slope_x[:, :-1])) ** 2
                        + (0.5 * (slope_y[1:, :] + slope_y[:-1, :])) ** 2)
        mean = 0.25 * (thickness[:-1, :-1] + thickness[1:, :-1] + thickness[:-1, 1:] + thickness[1:, 1:])
        diffusivity = factor * mean ** 5 * steep ** 2
        flux_x = -0.5 * (diffusivity[:, 1:] + diffusivity[:, :-1]) * slope_x[:, 1:-1]
        flux_y = -0.5 * (diffusivity[1:, :] + diffusivity[:-1, :]) * slope_y[1:-1, :]
        change = (flux_x[1:, :] - flux_x[:-1, :]) / dx + (flux_y[:, 1:] - flux_y[:, :-1]) / dx
        inner = torch.clamp(thickness[1:-1, 1:-1] + dt * (balance - change), min=0.0)
        thickness = thickness.clone()
        thickness[1:-1, 1:-1] = inner
    return thickness


def lattice(f, omega, steps):
    cx = torch.tensor([0, 1, 0, -1, 0, 1, -1, -1, 1])[:, None, None]
    cy = torch.tensor([0, 0, 1, 0, -1, 1, 1, -1, -1])[:, None, None]
    weight = torch.tensor([4 / 9] + [1 / 9] * 4 + [1 / 36] * 4, dtype=f.dtype)[:, None, None]
    for _ in range(steps):
        f = torch.stack([torch.roll(f[q], (int(cx[q]), int(cy[q])), (0, 1)) for q in range(9)])
        rho = torch.sum(f, dim=0)
        ux = torch.sum(f * cx, dim=0) / rho
        uy = torch.sum(f * cy, dim=0) / rho
        cu = 3.0 * (cx * ux + cy * uy)
        f = f + omega * (rho * weight * (1.0 + cu + 0.5 * cu ** 2 - 1.5 * (ux ** 2 + uy ** 2)) - f)
    return f


def attention(q, k, v):
    return torch.nn.functional.scaled_dot_product_attention(q, k, v)


def gmm(alpha, mu, q, l, x, gamma, m, sign):  # noqa: E741
    n, d = x.shape
    columns, rows = np.triu_indices(d, 1)
    factor = torch.diag_embed(torch.exp(q))
    factor[:, rows, columns] = l
    y = torch.einsum("kij,nkj->nki", factor, x[:, None, :] - mu)
    terms = alpha + torch.sum(q, dim=1) - 0.5 * torch.sum(y ** 2, dim=2)
    likelihood = (torch.sum(torch.logsumexp(terms, dim=1))
                  - n * (0.5 * d * math.log(2.0 * math.pi) + torch.logsumexp(alpha, dim=0)))
    freedom = d + m + 1
    constant = freedom * d * (math.log(gamma) - 0.5 * math.log(2.0)) - log_multigamma(0.5 * freedom, d)
    squares = torch.sum(factor ** 2)
    prior = alpha.shape[0] * constant - 0.5 * gamma * gamma * squares + m * torch.sum(q)
    return likelihood + sign * prior


def sigmoid(x):
    return 1.0 / (1.0 + torch.exp(-x))


def layer(weight, bias, hidden, cell, x):
    b = x.shape[0]
    forget = sigmoid(x * weight[:b] + bias[:b])
    ingate = sigmoid(hidden * weight[b:2 * b] + bias[b:2 * b])
    outgate = sigmoid(x * weight[2 * b:3 * b] + bias[2 * b:3 * b])
    cell = cell * forget + ingate * torch.tanh(hidden * weight[3 * b:] + bias[3 * b:])
    return outgate * torch.tanh(cell), cell


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
        total = total + torch.sum(sequence[t + 1] * (x - torch.log(2.0 + torch.sum(torch.exp(x)))))
    return -total / (b * (c - 1))


KERNELS = {f.__name__: f for f in (
    brusselator, integrate, jacobi, seidel, advect, mixture, nbody, glacier, lattice, attention, gmm,
    lstm)}
