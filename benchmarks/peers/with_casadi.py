"""The kernels as one writes them for CasADi: matrices of MX, or of SX, whose stores are elements' symbols.

CasADi has matrices only: fields on one grid, an array with three axes, are a list of matrices.
"""
from __future__ import annotations

import math
from itertools import product

import casadi as ca
import numpy as np

from benchmarks.gradbench.kernels.gmm import log_multigamma
from benchmarks.peers.problems import Problem, Run, Unsupported



def prepare(variant, kernel, problem: Problem) -> Run:
    """A function of the reverse derivative of the seeded sum, called with CasADi's own matrices."""
    if kernel not in KERNELS:
        raise Unsupported("no version of it is written")
    symbol = ca.MX if variant.endswith("MX") else ca.SX
    if symbol is ca.MX and kernel == "seidel":
        raise Unsupported("matrix expressions do not loop over elements")
    function, wrt = KERNELS[kernel], problem.case.wrt
    given = problem.taken(function)
    values = {name: matrices(given[name]) for name in wrt}
    symbols = {name: [symbol.sym(f"{name}_{k}", *m.shape) for k, m in enumerate(parts)]
               for name, parts in values.items()}
    constants = {name: whole(matrices(v), v) if isinstance(v, np.ndarray) else v for name, v in given.items()}
    found = function(**{**constants, **{name: whole(symbols[name], given[name]) for name in wrt}})
    outputs = found if isinstance(found, tuple) else (found,)
    loss = 0.0
    for output, seed in zip(outputs, problem.seeds):
        for part, weight in zip(output if isinstance(output, list) else [output], matrices(seed)):
            loss += ca.dot(part, weight)
    inputs = [s for name in wrt for s in symbols[name]]
    made = ca.Function("gradient", inputs, [ca.densify(ca.gradient(loss, s)) for s in inputs])
    operands = [ca.DM(m) for name in wrt for m in values[name]]
    return Run(lambda: made.call(operands), lambda found: arrays(found, [given[name] for name in wrt]))


def matrices(value):
    """The matrices that an array is."""
    if np.ndim(value) < 3:
        return [np.atleast_2d(value).T if np.ndim(value) == 1 else np.atleast_2d(value)]
    return [np.ascontiguousarray(m) for m in np.moveaxis(value, field_axis(value), 0)]


def field_axis(value):
    """The axis along which fields on a square grid lie."""
    return 0 if value.shape[1] == value.shape[2] else 2


def whole(parts, value):
    return parts if np.ndim(value) == 3 else parts[0]


def arrays(found, values):
    """The arrays of the matrices that CasADi gave, in the shapes of the values."""
    rest = [np.asarray(m.full()) for m in found]
    made = []
    for value in values:
        parts = [rest.pop(0) for _ in matrices(value)]
        made.append(np.stack(parts, field_axis(value)) if np.ndim(value) == 3 else parts[0].reshape(np.shape(value)))
    return made


def repeated(step, state, fixed, steps):
    """The state after so many steps: a fold of a function of MX, or the steps one after the other."""
    if isinstance(state, ca.SX):
        for _ in range(steps):
            state = step(state, *fixed)
        return state
    symbols = [ca.MX.sym(f"s{k}", *m.shape) for k, m in enumerate((state, *fixed))]
    one = ca.Function("step", symbols, [step(*symbols)])
    return one.fold(steps)(state, *(ca.repmat(m, 1, steps) for m in fixed))


def rolled(a, shift, axis):
    if axis == 0:
        return ca.vertcat(a[-shift:, :], a[:-shift, :])
    return ca.horzcat(a[:, -shift:], a[:, :-shift])


def brusselator(u, p, t):
    first, second = u
    a, b, alpha, dx = p[0], p[1], p[2], p[3]
    n = first.shape[0]
    x = ca.repmat(ca.DM(np.arange(n)) * dx, 1, n)
    inside = (x - 0.3) ** 2 + (x.T - 0.6) ** 2 <= 0.01
    forcing = ca.if_else(inside, 5.0, 0.0) if t >= 1.1 else 0.0
    reaction = first ** 2 * second
    return [alpha / dx ** 2 * spread(first) + b + reaction - (a + 1.0) * first + forcing,
            alpha / dx ** 2 * spread(second) + a * first - reaction]


def spread(u):
    return rolled(u, 1, 0) + rolled(u, -1, 0) + rolled(u, 1, 1) + rolled(u, -1, 1) - 4.0 * u


def integrate(u, p, dt, steps):
    n = u[0].shape[0]

    def step(u, p):
        du = brusselator([u[:, :n], u[:, n:]], p, 0.0)      # before t = 1.1 nothing is forced
        return u + dt * ca.horzcat(*du)

    return 0.5 * ca.sumsqr(repeated(step, ca.horzcat(*u), [p], steps))


def averaged(a):
    return 0.2 * (a[1:-1, 1:-1] + a[1:-1, :-2] + a[1:-1, 2:] + a[2:, 1:-1] + a[:-2, 1:-1])


def framed(a, inner):
    return ca.vertcat(a[0, :], ca.horzcat(a[1:-1, 0], inner, a[1:-1, -1]), a[-1, :])


def jacobi(a, b, steps):
    n = a.shape[0]

    def step(both):
        a, b = both[:, :n], both[:, n:]
        b = framed(b, averaged(a))
        return ca.horzcat(framed(a, averaged(b)), b)

    return repeated(step, ca.horzcat(a, b), [], steps)[:, :n]


def seidel(a, steps):
    n = a.shape[0]
    a = ca.SX(a)
    for _ in range(steps):
        for i, j in product(range(1, n - 1), range(1, n - 1)):
            a[i, j] = (a[i - 1, j - 1] + a[i - 1, j] + a[i - 1, j + 1] + a[i, j - 1] + a[i, j]
                       + a[i, j + 1] + a[i + 1, j - 1] + a[i + 1, j] + a[i + 1, j + 1]) / 9.0
    return 0.5 * ca.sumsqr(a)


def minmod(a, b):
    return ca.if_else(a * b <= 0.0, 0.0, ca.if_else(ca.fabs(a) < ca.fabs(b), a, b))


def advect(u, c, steps):
    def step(u, c):
        flux = c * (u + 0.5 * (1.0 - c) * minmod(u - rolled(u, 1, 0), rolled(u, -1, 0) - u))
        return u - (flux - rolled(flux, 1, 0))

    return repeated(step, u, [c], steps)


def log_sum_exp(values):
    top = values[:, 0]
    for column in range(1, values.shape[1]):
        top = ca.fmax(top, values[:, column])
    return top + ca.log(ca.sum2(ca.exp(values - ca.repmat(top, 1, values.shape[1]))))


def mixture(alphas, means, scales, x):
    n, d = x.shape
    terms = []
    for c in range(alphas.shape[0]):
        z = ca.repmat(ca.exp(scales[c, :]), n, 1) * (ca.DM(x) - ca.repmat(means[c, :], n, 1))
        terms.append(alphas[c] + ca.sum2(scales[c, :]) - 0.5 * ca.sum2(z ** 2))
    return ca.sum1(log_sum_exp(ca.horzcat(*terms))) - n * log_sum_exp(alphas.T)


def nbody(position, velocity, mass, dt, steps, softening):
    n = mass.shape[0]

    def step(state, mass):
        position, velocity = state[:, :3], state[:, 3:]
        apart = [ca.repmat(position[:, d].T, n, 1) - ca.repmat(position[:, d], 1, n) for d in range(3)]
        inverse = (apart[0] ** 2 + apart[1] ** 2 + apart[2] ** 2 + softening * softening) ** -1.5
        velocity = velocity + dt * ca.horzcat(*((inverse * one) @ mass for one in apart))
        return ca.horzcat(position + dt * velocity, velocity)

    state = repeated(step, ca.horzcat(position, velocity), [mass], steps)
    return 0.5 * ca.dot(mass, ca.sum2(state[:, 3:] ** 2)), state[:, :3]


def glacier(thickness, bed, rate, balance, dx, dt, steps):
    def step(thickness, bed, rate, balance):
        factor = 2.0 * rate * (917.0 * 9.81) ** 3 / 5.0
        surface = bed + thickness
        slope_x = (surface[1:, :] - surface[:-1, :]) / dx
        slope_y = (surface[:, 1:] - surface[:, :-1]) / dx
        steep = ca.sqrt((0.5 * (slope_x[:, 1:] + slope_x[:, :-1])) ** 2
                        + (0.5 * (slope_y[1:, :] + slope_y[:-1, :])) ** 2)
        mean = 0.25 * (thickness[:-1, :-1] + thickness[1:, :-1] + thickness[:-1, 1:] + thickness[1:, 1:])
        diffusivity = factor * mean ** 5 * steep ** 2
        flux_x = -0.5 * (diffusivity[:, 1:] + diffusivity[:, :-1]) * slope_x[:, 1:-1]
        flux_y = -0.5 * (diffusivity[1:, :] + diffusivity[:-1, :]) * slope_y[1:-1, :]
        change = (flux_x[1:, :] - flux_x[:-1, :]) / dx + (flux_y[:, 1:] - flux_y[:, :-1]) / dx
        return framed(thickness, ca.fmax(thickness[1:-1, 1:-1] + dt * (balance - change), 0.0))

    return repeated(step, thickness, [bed, rate, balance], steps)


def lattice(f, omega, steps):
    cx, cy = (0, 1, 0, -1, 0, 1, -1, -1, 1), (0, 0, 1, 0, -1, 1, 1, -1, -1)
    weight = [4 / 9] + [1 / 9] * 4 + [1 / 36] * 4
    n = f[0].shape[0]

    def step(f, omega):
        f = [f[:, q * n:(q + 1) * n] for q in range(9)]
        f = [rolled(rolled(g, x, 0) if x else g, y, 1) if y else (rolled(g, x, 0) if x else g)
             for g, x, y in zip(f, cx, cy)]
        rho = sum(f)
        ux, uy = (sum(c * g for c, g in zip(along, f) if c) / rho for along in (cx, cy))
        cu = [3.0 * (x * ux + y * uy) for x, y in zip(cx, cy)]
        return ca.horzcat(*(g + omega * (rho * w * (1.0 + s + 0.5 * s ** 2 - 1.5 * (ux ** 2 + uy ** 2)) - g)
                            for g, w, s in zip(f, weight, cu)))

    f = repeated(step, ca.horzcat(*f), [omega], steps)
    return [f[:, q * n:(q + 1) * n] for q in range(9)]


def attention(q, k, v):
    weight = ca.exp(q @ k.T * (1.0 / np.sqrt(q.shape[1])))
    return weight @ v / ca.repmat(ca.sum2(weight), 1, v.shape[1])


def gmm(alpha, mu, q, l, x, gamma, m, sign):  # noqa: E741
    n, d = x.shape
    columns, rows = np.triu_indices(d, 1)
    basis = np.zeros((d * d, rows.size))
    basis[columns * d + rows, np.arange(rows.size)] = 1.0
    terms, squares = [], 0.0
    for k in range(alpha.shape[0]):
        factor = ca.diag(ca.exp(q[k, :])) + ca.reshape(ca.DM(basis) @ l[k, :].T, d, d)
        y = (ca.DM(x) - ca.repmat(mu[k, :], n, 1)) @ factor.T
        terms.append(alpha[k] + ca.sum2(q[k, :]) - 0.5 * ca.sum2(y ** 2))
        squares += ca.sumsqr(factor)
    likelihood = (ca.sum1(log_sum_exp(ca.horzcat(*terms)))
                  - n * (0.5 * d * math.log(2.0 * math.pi) + log_sum_exp(alpha.T)))
    freedom = d + m + 1
    constant = freedom * d * (math.log(gamma) - 0.5 * math.log(2.0)) - log_multigamma(0.5 * freedom, d)
    prior = alpha.shape[0] * constant - 0.5 * gamma * gamma * squares + m * ca.sum1(ca.sum2(q))
    return likelihood + sign * prior


def sigmoid(x):
    return 1.0 / (1.0 + ca.exp(-x))


def layer(weight, bias, hidden, cell, x):
    b = x.shape[1]
    forget = sigmoid(x * weight[:, :b] + bias[:, :b])
    ingate = sigmoid(hidden * weight[:, b:2 * b] + bias[:, b:2 * b])
    outgate = sigmoid(x * weight[:, 2 * b:3 * b] + bias[:, 2 * b:3 * b])
    cell = cell * forget + ingate * ca.tanh(hidden * weight[:, 3 * b:] + bias[:, 3 * b:])
    return outgate * ca.tanh(cell), cell


def lstm(main_params, extra_params, state, sequence):
    c, b = sequence.shape
    state = [ca.DM(state[k, :]).T if state[k, :].ndim == 1 else state[k, :] for k in range(state.shape[0])]
    total = 0.0
    for t in range(c - 1):
        x = ca.DM(sequence[t, :]).T * extra_params[0, :]
        for k in range(0, len(state), 2):
            state[k], state[k + 1] = layer(main_params[k, :], main_params[k + 1, :], state[k], state[k + 1], x)
            x = state[k]
        x = x * extra_params[1, :] + extra_params[2, :]
        total += ca.dot(ca.DM(sequence[t + 1, :]).T, x - ca.log(2.0 + ca.sum2(ca.exp(x))))
    return -total / (b * (c - 1))


KERNELS = {f.__name__: f for f in (
    brusselator, integrate, jacobi, seidel, advect, mixture, nbody, glacier, lattice, attention, gmm,
    lstm)}
