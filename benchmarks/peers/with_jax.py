"""The kernels as one writes them for JAX: no stores, a scan over the steps, `jit` of `vjp`."""
from __future__ import annotations

import math
from contextvars import ContextVar

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.gradbench.kernels.gmm import log_multigamma
from benchmarks.peers.problems import Problem, Run, Unsupported

_CHECKPOINT = ContextVar("_CHECKPOINT", default=False)
_LOOP = ContextVar("_LOOP", default=None)
jax.config.update("jax_enable_x64", True)


def prepare(variant, kernel, problem: Problem) -> Run:
    """The compiled pullback of the seeds, on arrays that JAX holds; with the steps of scans run again, or kept."""
    if kernel not in KERNELS:
        raise Unsupported("no version of it is written")
    if variant != "JAX" and kernel not in STEPPED:
        raise Unsupported("no steps to run again")
    function = KERNELS[kernel]
    given = problem.taken(function)
    inputs = [jax.device_put(given.pop(name)) for name in problem.case.wrt]
    seeds = [jax.device_put(np.float64(s) if np.ndim(s) == 0 else s) for s in problem.seeds]

    def outputs(*inputs):
        found = function(**given, **dict(zip(problem.case.wrt, inputs)))
        return found if isinstance(found, tuple) else (found,)

    pulled = jax.jit(lambda inputs, seeds: jax.vjp(outputs, *inputs)[1](tuple(seeds)))
    token = _CHECKPOINT.set(variant != "JAX")
    try:
        jax.block_until_ready(pulled(inputs, seeds))
    finally:
        _CHECKPOINT.reset(token)
    return Run(lambda: jax.block_until_ready(pulled(inputs, seeds)), lambda found: [np.asarray(g) for g in found])


def repeated(step, state, steps):
    return (_LOOP.get() or scanned)(step, state, steps)


def scanned(step, state, steps):
    body = remembered(step)
    return jax.lax.scan(lambda state, _: (body(state), None), state, None, length=steps)[0]


def in_chunks(count):
    """A loop of `count` scans, each of which runs again from the state that it finds."""
    def loop(step, state, steps):
        inner, left = divmod(steps, count)
        chunk = jax.checkpoint(lambda state, _: (scanned(step, state, inner), None))
        return scanned(step, jax.lax.scan(chunk, state, None, length=count)[0], left)
    return loop


def checkpointed(count):
    """Equinox's loop over so many checkpoints."""
    from equinox.internal import scan

    def loop(step, state, steps):
        return scan(lambda state, _: (step(state), None), state, None, length=steps, kind="checkpointed",
                    checkpoints=count)[0]
    return loop


def stepped_gradient(kernel, arguments, loop):
    """The compiled gradient of a kernel's result, or of its sum, with respect to its first argument, on arrays that JAX
    holds; and the bytes that it takes beside them."""
    first, *others = arguments

    def value(first):
        return jnp.sum(KERNELS[kernel](first, *others))
    token = _LOOP.set(loop)
    try:
        made = jax.jit(jax.grad(value)).lower(first).compile()
    finally:
        _LOOP.reset(token)
    held = jax.device_put(first)
    return lambda: jax.block_until_ready(made(held)), made.memory_analysis().temp_size_in_bytes


def remembered(step):
    return jax.checkpoint(step) if _CHECKPOINT.get() else step


def brusselator(u, p, t):
    a, b, alpha, dx = p
    n = u.shape[0]
    x = jnp.arange(n) * dx
    inside = (x[:, None] - 0.3) ** 2 + (x[None, :] - 0.6) ** 2 <= 0.01
    forcing = jnp.where(inside & (t >= 1.1), 5.0, 0.0)
    neighbours = jnp.roll(u, 1, 0) + jnp.roll(u, -1, 0) + jnp.roll(u, 1, 1) + jnp.roll(u, -1, 1)
    diffusion = alpha / dx ** 2 * (neighbours - 4.0 * u)
    first, second = u[:, :, 0], u[:, :, 1]
    reaction = first ** 2 * second
    return diffusion + jnp.stack([b + reaction - (a + 1.0) * first + forcing, a * first - reaction], axis=2)


def integrate(u, p, dt, steps):
    def step(state):
        u, s = state
        return u + dt * brusselator(u, p, s * dt), s + 1

    u, _ = repeated(step, (u, 0), steps)
    return 0.5 * jnp.sum(u ** 2)


def averaged(a):
    return 0.2 * (a[1:-1, 1:-1] + a[1:-1, :-2] + a[1:-1, 2:] + a[2:, 1:-1] + a[:-2, 1:-1])


def jacobi(a, b, steps):
    def step(state):
        a, b = state
        b = b.at[1:-1, 1:-1].set(averaged(a))
        return a.at[1:-1, 1:-1].set(averaged(b)), b

    return repeated(step, (a, b), steps)[0]


def seidel(a, steps):
    def row(above, rows):
        here, below = rows
        old = (above[:-2] + above[1:-1] + above[2:] + here[1:-1] + here[2:] + below[:-2] + below[1:-1] + below[2:])
        _, new = jax.lax.scan(lambda left, c: 2 * ((left + c) / 9.0,), here[0], old)
        here = here.at[1:-1].set(new)
        return here, here

    def sweep(a):
        _, rows = jax.lax.scan(row, a[0], (a[1:-1], a[2:]))
        return a.at[1:-1].set(rows)

    return 0.5 * jnp.sum(repeated(sweep, a, steps) ** 2)


def minmod(a, b):
    return jnp.where(a * b <= 0.0, 0.0, jnp.where(jnp.abs(a) < jnp.abs(b), a, b))


def advect(u, c, steps):
    def step(u):
        flux = c * (u + 0.5 * (1.0 - c) * minmod(u - jnp.roll(u, 1), jnp.roll(u, -1) - u))
        return u - (flux - jnp.roll(flux, 1))

    return repeated(step, u, steps)


def mixture(alphas, means, scales, x):
    z = jnp.exp(scales) * (x[:, None, :] - means)
    term = alphas + jnp.sum(scales, axis=1) - 0.5 * jnp.sum(z ** 2, axis=2)
    return jnp.sum(jax.nn.logsumexp(term, axis=1)) - x.shape[0] * jax.nn.logsumexp(alphas)


def nbody(position, velocity, mass, dt, steps, softening):
    def step(state):
        position, velocity = state
        apart = position[None, :, :] - position[:, None, :]
        inverse = (jnp.sum(apart ** 2, axis=2) + softening * softening) ** -1.5
        velocity = velocity + dt * jnp.sum((mass * inverse)[:, :, None] * apart, axis=1)
        return position + dt * velocity, velocity

    position, velocity = repeated(step, (position, velocity), steps)
    return jnp.sum(0.5 * mass * jnp.sum(velocity ** 2, axis=1)), position


def glacier(thickness, bed, rate, balance, dx, dt, steps):
    factor = 2.0 * rate * (917.0 * 9.81) ** 3 / 5.0

    def step(thickness):
        surface = bed + thickness
        slope_x = (surface[1:, :] - surface[:-1, :]) / dx
        slope_y = (surface[:, 1:] - surface[:, :-1]) / dx
        steep = jnp.sqrt((0.5 * (slope_x[:, 1:] + slope_x[:, :-1])) ** 2
                         + (0.5 * (slope_y[1:, :] + slope_y[:-1, :])) ** 2)
        mean = 0.25 * (thickness[:-1, :-1] + thickness[1:, :-1] + thickness[:-1, 1:] + thickness[1:, 1:])
        diffusivity = factor * mean ** 5 * steep ** 2
        flux_x = -0.5 * (diffusivity[:, 1:] + diffusivity[:, :-1]) * slope_x[:, 1:-1]
        flux_y = -0.5 * (diffusivity[1:, :] + diffusivity[:-1, :]) * slope_y[1:-1, :]
        change = (flux_x[1:, :] - flux_x[:-1, :]) / dx + (flux_y[:, 1:] - flux_y[:, :-1]) / dx
        return thickness.at[1:-1, 1:-1].set(jnp.maximum(thickness[1:-1, 1:-1] + dt * (balance - change), 0.0))

    return repeated(step, thickness, steps)


def attention(q, k, v):
    return jax.nn.softmax((q @ k.T) * (1.0 / np.sqrt(q.shape[1])), axis=1) @ v


def lattice(f, omega, steps):
    cx, cy = (0, 1, 0, -1, 0, 1, -1, -1, 1), (0, 0, 1, 0, -1, 1, 1, -1, -1)
    weight = [4 / 9] + [1 / 9] * 4 + [1 / 36] * 4

    def step(f):
        f = [jnp.roll(g, (x, y), (0, 1)) for g, x, y in zip(f, cx, cy)]
        rho = sum(f)
        ux, uy = (sum(c * g for c, g in zip(along, f) if c) / rho for along in (cx, cy))

        def relaxed(g, w, x, y):
            cu = 3.0 * (x * ux + y * uy)
            return g + omega * (rho * w * (1.0 + cu + 0.5 * cu ** 2 - 1.5 * (ux ** 2 + uy ** 2)) - g)

        return tuple(map(relaxed, f, weight, cx, cy))

    return jnp.stack(repeated(step, tuple(f[q] for q in range(9)), steps))


def gmm(alpha, mu, q, l, x, gamma, m, sign):  # noqa: E741
    n, d = x.shape
    columns, rows = np.triu_indices(d, 1)
    factor = (jnp.exp(q)[:, :, None] * jnp.eye(d)).at[:, rows, columns].set(l)
    y = jnp.einsum("kij,nkj->nki", factor, x[:, None, :] - mu)
    terms = alpha + jnp.sum(q, axis=1) - 0.5 * jnp.sum(y ** 2, axis=2)
    likelihood = (jnp.sum(jax.nn.logsumexp(terms, axis=1))
                  - n * (0.5 * d * math.log(2.0 * math.pi) + jax.nn.logsumexp(alpha)))
    freedom = d + m + 1
    constant = freedom * d * (math.log(gamma) - 0.5 * math.log(2.0)) - log_multigamma(0.5 * freedom, d)
    squares = jnp.sum(factor ** 2)
    prior = alpha.shape[0] * constant - 0.5 * gamma * gamma * squares + m * jnp.sum(q)
    return likelihood + sign * prior


def sigmoid(x):
    return 1.0 / (1.0 + jnp.exp(-x))


def layer(weight, bias, hidden, cell, x):
    b = x.shape[0]
    forget = sigmoid(x * weight[:b] + bias[:b])
    ingate = sigmoid(hidden * weight[b:2 * b] + bias[b:2 * b])
    outgate = sigmoid(x * weight[2 * b:3 * b] + bias[2 * b:3 * b])
    cell = cell * forget + ingate * jnp.tanh(hidden * weight[3 * b:] + bias[3 * b:])
    return outgate * jnp.tanh(cell), cell


def lstm(main_params, extra_params, state, sequence):
    c, b = sequence.shape

    def step(state, rows):
        row, following = rows
        x = row * extra_params[0]
        for k in range(0, len(state), 2):
            hidden, cell = layer(main_params[k], main_params[k + 1], state[k], state[k + 1], x)
            state, x = (*state[:k], hidden, cell, *state[k + 2:]), hidden
        x = x * extra_params[1] + extra_params[2]
        return state, jnp.sum(following * (x - jnp.log(2.0 + jnp.sum(jnp.exp(x)))))

    _, totals = jax.lax.scan(remembered(step), tuple(state), (sequence[:-1], sequence[1:]))
    return -jnp.sum(totals) / (b * (c - 1))


KERNELS = {f.__name__: f for f in (
    brusselator, integrate, jacobi, seidel, advect, mixture, nbody, glacier, lattice, attention, gmm, lstm)}
STEPPED = {*KERNELS} - {"brusselator", "mixture", "attention", "gmm"}
