"""The kernels as JAX users write them: whole arrays, `lax.scan` over steps, no stores. Needs JAX.

Each takes the parameters of its kernel that it needs, by name, and gives the outputs of the case, a tuple where these
are several.
"""
from __future__ import annotations

import jax
import jax.numpy as jnp
from jax import lax


def _repeated(step, state, count):
    return lax.scan(lambda s, _: (step(s), None), state, None, length=count)[0]


# -- linear algebra -------------------------------------------------------------------------------------------------

def gemm(alpha, beta, C, A, B):
    return alpha * A @ B + beta * C


def k2mm(alpha, beta, A, B, C, D):
    return alpha * A @ B @ C + beta * D


def k3mm(A, B, C, D):
    return A @ B @ C @ D


def gemver(alpha, beta, A, u1, v1, u2, v2, w, x, y, z):
    A = A + jnp.outer(u1, v1) + jnp.outer(u2, v2)
    x = x + beta * y @ A + z
    return A, w + alpha * A @ x, x


def gesummv(alpha, beta, A, B, x):
    return alpha * A @ x + beta * B @ x


def atax(A, x):
    return (A @ x) @ A


def bicg(A, p, r):
    return r @ A, A @ p


def mvt(x1, x2, y1, y2, A):
    return x1 + A @ y1, x2 + y2 @ A


def _lower(new, C):
    return jnp.where(jnp.tri(C.shape[0], dtype=bool), new, C)


def syrk(alpha, beta, C, A):
    return _lower(beta * C + alpha * A @ A.T, C)


def syr2k(alpha, beta, C, A, B):
    return _lower(beta * C + alpha * (B @ A.T + A @ B.T), C)


def trmm(alpha, A, B):
    return alpha * (B + jnp.tril(A, -1).T @ B)


def symm(alpha, beta, C, A, B):
    below = jnp.tril(A, -1)
    return beta * C + alpha * (below + below.T + jnp.diag(jnp.diag(A))) @ B


def doitgen(A, C4):
    return A @ C4


def cholesky(A):
    below = jnp.tril(A, -1)
    return _lower(jnp.linalg.cholesky(below + below.T + jnp.diag(jnp.diag(A)), symmetrize_input=False), A)


def trisolv(L, b):
    return jax.scipy.linalg.solve_triangular(L, b, lower=True)


def gramschmidt(A):
    Q, R = jnp.linalg.qr(A)
    signs = jnp.sign(jnp.diag(R))
    return Q * signs, R * signs[:, None]


def floyd_warshall(path):
    def through(k, p):
        return jnp.minimum(p, p[:, k][:, None] + p[k, :][None, :])
    return lax.fori_loop(0, path.shape[0], through, path)


# -- stencils -------------------------------------------------------------------------------------------------------

def jacobi_1d(steps, A, B):
    def step(state):
        A, B = state
        B = B.at[1:-1].set(0.33333 * (A[:-2] + A[1:-1] + A[2:]))
        return A.at[1:-1].set(0.33333 * (B[:-2] + B[1:-1] + B[2:])), B
    return _repeated(step, (A, B), steps - 1)


def jacobi_2d(steps, A, B):
    def mean(a):
        return 0.2 * (a[1:-1, 1:-1] + a[1:-1, :-2] + a[1:-1, 2:] + a[2:, 1:-1] + a[:-2, 1:-1])

    def step(state):
        A, B = state
        B = B.at[1:-1, 1:-1].set(mean(A))
        return A.at[1:-1, 1:-1].set(mean(B)), B
    return _repeated(step, (A, B), steps - 1)


def heat_3d(steps, A, B):
    def heated(a):
        c = a[1:-1, 1:-1, 1:-1]
        return (0.125 * (a[2:, 1:-1, 1:-1] - 2.0 * c + a[:-2, 1:-1, 1:-1])
                + 0.125 * (a[1:-1, 2:, 1:-1] - 2.0 * c + a[1:-1, :-2, 1:-1])
                + 0.125 * (a[1:-1, 1:-1, 2:] - 2.0 * c + a[1:-1, 1:-1, :-2]) + c)

    def step(state):
        A, B = state
        B = B.at[1:-1, 1:-1, 1:-1].set(heated(A))
        return A.at[1:-1, 1:-1, 1:-1].set(heated(B)), B
    return _repeated(step, (A, B), steps - 1)


def fdtd_2d(ex, ey, hz, fict):
    def step(state, f):
        ex, ey, hz = state
        ey = ey.at[0, :].set(f).at[1:, :].add(-0.5 * (hz[1:, :] - hz[:-1, :]))
        ex = ex.at[:, 1:].add(-0.5 * (hz[:, 1:] - hz[:, :-1]))
        return (ex, ey, hz.at[:-1, :-1].add(-0.7 * (ex[:-1, 1:] - ex[:-1, :-1] + ey[1:, :-1] - ey[:-1, :-1]))), None
    return lax.scan(step, (ex, ey, hz), fict)[0]


def adi(steps, u):
    n = u.shape[0]
    mul = 0.2 / steps * n * n * 1e-2
    a, b = -mul / 2.0, 1.0 + mul

    def swept(source, target):
        def down(carry, row):
            p, q = carry
            m = a * p + b
            new = -a / m, (-a * row[:-2] + (1.0 + 2.0 * a) * row[1:-1] - a * row[2:] - a * q) / m
            return new, new
        first = jnp.zeros(n - 2), jnp.ones(n - 2)
        p, q = lax.scan(down, first, source[1:-1])[1]
        rows = lax.scan(lambda after, pq: (pq[0] * after + pq[1],) * 2, jnp.ones(n - 2), (p, q), reverse=True)[1]
        return target.at[1:-1, 1:-1].set(rows).at[0, 1:-1].set(1.0).at[n - 1, 1:-1].set(1.0)

    def step(u):
        return swept(swept(u, jnp.zeros_like(u)).T, u.T).T
    return _repeated(step, u, steps)


def deriche(alpha, image):
    k = (1.0 - jnp.exp(-alpha)) ** 2 / (1.0 + alpha * jnp.exp(-alpha) - jnp.exp(2.0 * alpha))
    a1, a2 = k, k * jnp.exp(-alpha) * (alpha - 1.0)
    a3, a4 = k * jnp.exp(-alpha) * (alpha + 1.0), -k * jnp.exp(-2.0 * alpha)
    b1, b2 = 2.0 ** (-alpha), -jnp.exp(-2.0 * alpha)

    def recursive(rows):
        def step(carry, row):
            x1, y1, y2, first, second = carry
            y = first * row + second * x1 + b1 * y1 + b2 * y2
            return (row, y, y1, first, second), y
        zero = jnp.zeros_like(rows[0])
        forth = lax.scan(step, (zero, zero, zero, a1, a2), rows)[1]
        shifted = jnp.concatenate([rows[1:], zero[None]])
        back = lax.scan(step, (zero, zero, zero, a3, a4), shifted, reverse=True)[1]
        return forth + back
    return recursive(recursive(image.T).T)


def hdiff(field, coefficient):
    lap = 4.0 * field[1:-1, 1:-1] - (field[2:, 1:-1] + field[:-2, 1:-1] + field[1:-1, 2:] + field[1:-1, :-2])
    res = lap[1:, 1:-1] - lap[:-1, 1:-1]
    fx = jnp.where(res * (field[2:-1, 2:-2] - field[1:-2, 2:-2]) > 0.0, 0.0, res)
    res = lap[1:-1, 1:] - lap[1:-1, :-1]
    fy = jnp.where(res * (field[2:-2, 2:-1] - field[2:-2, 1:-2]) > 0.0, 0.0, res)
    return field[2:-2, 2:-2] - coefficient * (fx[1:] - fx[:-1] + fy[:, 1:] - fy[:, :-1])


def vadv(utens, u, w, dt):
    ut, uu, ww = (jnp.moveaxis(a, 2, 0) for a in (utens, u, w))
    zero = jnp.zeros_like(ww[:1])
    ga = jnp.concatenate([zero, -0.25 * ww[1:]])
    gc = jnp.concatenate([0.25 * ww[1:], zero])
    before, after = jnp.concatenate([uu[:1], uu[:-1]]), jnp.concatenate([uu[1:], uu[-1:]])
    right = uu / dt + ut - ga * (before - uu) - gc * (after - uu)

    def down(carry, level):
        c, d = carry
        ga, gc, right = level
        divided = 1.0 / (1.0 / dt - ga - gc - c * ga)
        new = gc * divided, (right - d * ga) * divided
        return new, new
    c, d = lax.scan(down, (jnp.zeros_like(ww[0]),) * 2, (ga, gc, right))[1]
    found = lax.scan(lambda x, cd: (cd[1] - cd[0] * x,) * 2, jnp.zeros_like(ww[0]), (c, d), reverse=True)[1]
    return jnp.moveaxis((found - uu) / dt, 0, 2)


def crank_nicolson(u, r, steps):
    def step(u):
        right = r * u[:-2] + (2.0 - 2.0 * r) * u[1:-1] + r * u[2:]

        def down(carry, b):
            c, d = carry
            m = 2.0 + 2.0 * r + r * c
            new = -r / m, (b + r * d) / m
            return new, new
        c, d = lax.scan(down, (jnp.zeros(()), jnp.zeros(())), right)[1]
        inner = lax.scan(lambda x, cd: (cd[1] - cd[0] * x,) * 2, u[-1], (c, d), reverse=True)[1]
        return u.at[1:-1].set(inner)
    return _repeated(step, u, steps)


def tvd(u, c, steps):
    def step(u):
        du = jnp.roll(u, -1) - u
        r = jnp.roll(du, 1) / (du + 1e-12)
        flux = u + 0.5 * (1.0 - c) * (r + jnp.abs(r)) / (1.0 + jnp.abs(r)) * du
        return u - c * (flux - jnp.roll(flux, 1))
    return _repeated(step, u, steps)


# -- learning -------------------------------------------------------------------------------------------------------

def covariance(data):
    data = data - jnp.mean(data, axis=0)
    return data.T @ data / (data.shape[0] - 1.0)


def correlation(data):
    stddev = jnp.std(data, axis=0)
    stddev = jnp.where(stddev <= 0.1, 1.0, stddev)
    data = (data - jnp.mean(data, axis=0)) / (jnp.sqrt(data.shape[0]) * stddev)
    corr = data.T @ data
    return jnp.where(jnp.eye(data.shape[1], dtype=bool), 1.0, corr)


def arc_distance(theta_1, phi_1, theta_2, phi_2):
    temp = jnp.sin((theta_2 - theta_1) / 2) ** 2 \
        + jnp.cos(theta_1) * jnp.cos(theta_2) * jnp.sin((phi_2 - phi_1) / 2) ** 2
    return 2 * jnp.arctan2(jnp.sqrt(temp), jnp.sqrt(1 - temp))


def go_fast(a):
    return a + jnp.sum(jnp.tanh(jnp.diag(a)))


def softmax(x):
    return jax.nn.softmax(x, axis=-1)


def mlp(x, w1, b1, w2, b2, w3, b3):
    return softmax(jax.nn.relu(jax.nn.relu(x @ w1 + b1) @ w2 + b2) @ w3 + b3)


def conv2d_bias(x, weights, bias):
    return lax.conv_general_dilated(x, weights, (1, 1), "VALID", dimension_numbers=("NHWC", "HWIO", "NHWC")) + bias


def batch_norm(x, gamma, beta):
    return gamma * (x - jnp.mean(x, axis=0)) / jnp.sqrt(jnp.var(x, axis=0) + 1e-5) + beta


def soft_dtw(D, gamma):
    def row(above, costs):
        def cell(left, inputs):
            corner, up, cost = inputs
            best = jnp.stack([corner, up, left])
            new = cost - gamma * jax.nn.logsumexp(-best / gamma)
            return new, new
        cells = lax.scan(cell, jnp.asarray(1e10), (above[:-1], above[1:], costs))[1]
        return jnp.concatenate([jnp.asarray([1e10]), cells]), None
    first = jnp.full(D.shape[1] + 1, 1e10).at[0].set(0.0)
    return lax.scan(row, first, D)[0][-1]


def hmm_forward(start, moves, emits, seen):
    def step(alpha, symbol):
        alpha = (alpha @ moves) * emits[:, symbol]
        return alpha / jnp.sum(alpha), jnp.log(jnp.sum(alpha))
    alpha = start * emits[:, seen[0]]
    return jnp.log(jnp.sum(alpha)) + jnp.sum(lax.scan(step, alpha / jnp.sum(alpha), seen[1:])[1])


# -- physics --------------------------------------------------------------------------------------------------------

def _distances(position, box):
    d = position[:, None, :] - position[None, :, :]
    d = d - box * jnp.round(d / box)
    r2 = jnp.sum(d * d, axis=-1)
    near = (r2 < 6.25) & ~jnp.eye(position.shape[0], dtype=bool)
    return d, jnp.where(near, r2, 1.0), near


def lennard_jones(position, box):
    _, r2, near = _distances(position, box)
    s6 = 1.0 / r2 ** 3
    return 0.5 * jnp.sum(jnp.where(near, 4.0 * (s6 * s6 - s6), 0.0))


def lj_forces(position, force, box):
    d, r2, near = _distances(position, box)
    s6 = 1.0 / r2 ** 3
    return force + jnp.sum(jnp.where(near, 48.0 * s6 * (s6 - 0.5) / r2, 0.0)[:, :, None] * d, axis=1)


def boris(x, v, E, B, q, dt, steps):
    t = 0.5 * dt * q[:, None] * B
    s = 2.0 * t / (1.0 + jnp.sum(t * t, axis=1, keepdims=True))
    kick = 0.5 * dt * q[:, None] * E

    def step(state):
        x, v = state
        minus = v + kick
        v = minus + jnp.cross(minus + jnp.cross(minus, t), s) + kick
        return x + dt * v, v
    return _repeated(step, (x, v), steps)


def two_body_pairs(pos, mass, G, softening):
    x, y, z = pos[:, 0:1], pos[:, 1:2], pos[:, 2:3]
    dx, dy, dz = x.T - x, y.T - y, z.T - z
    inv_r3 = (dx ** 2 + dy ** 2 + dz ** 2 + softening ** 2) ** (-1.5)
    return jnp.hstack([G * (d * inv_r3) @ mass for d in (dx, dy, dz)])


def hll(rho, m, E, ratio, steps):
    def step(q):
        rho, m, E = q
        u = m / rho
        p = 0.4 * (E - 0.5 * rho * u * u)
        c, f = jnp.sqrt(1.4 * p / rho), jnp.stack([m, m * u + p, u * (E + p)])
        sl = jnp.minimum((u - c)[:-1], (u - c)[1:])
        sr = jnp.maximum((u + c)[:-1], (u + c)[1:])
        mixed = (sr * f[:, :-1] - sl * f[:, 1:] + sl * sr * (q[:, 1:] - q[:, :-1])) / (sr - sl)
        flux = jnp.where(sl >= 0.0, f[:, :-1], jnp.where(sr <= 0.0, f[:, 1:], mixed))
        return q.at[:, 1:-1].add(-ratio * (flux[:, 1:] - flux[:, :-1]))
    q = _repeated(step, jnp.stack([rho, m, E]), steps)
    return q[0], q[1], q[2]


def roe(q, ratio, steps):
    def step(q):
        rho, u = q[0], q[1] / q[0]
        p = 0.4 * (q[2] - 0.5 * rho * u ** 2)
        H, w = (q[2] + p) / rho, jnp.sqrt(rho)
        flux = jnp.stack((q[1], q[1] * u + p, u * (q[2] + p)))
        ua = (w[:-1] * u[:-1] + w[1:] * u[1:]) / (w[:-1] + w[1:])
        ha = (w[:-1] * H[:-1] + w[1:] * H[1:]) / (w[:-1] + w[1:])
        a = jnp.sqrt(0.4 * (ha - 0.5 * ua ** 2))
        d = q[:, 1:] - q[:, :-1]
        a2 = 0.4 / a ** 2 * ((ha - ua ** 2) * d[0] + ua * d[1] - d[2])
        a1 = 0.5 / a * ((ua + a) * d[0] - d[1] - a * a2)
        l1, l2, l3 = jnp.abs(ua - a) * a1, jnp.abs(ua) * a2, jnp.abs(ua + a) * (d[0] - a1 - a2)
        jump = jnp.stack((l1 + l2 + l3, (ua - a) * l1 + ua * l2 + (ua + a) * l3,
                          (ha - ua * a) * l1 + 0.5 * ua ** 2 * l2 + (ha + ua * a) * l3))
        between = 0.5 * (flux[:, :-1] + flux[:, 1:] - jump)
        return q.at[:, 1:-1].add(-ratio * (between[:, 1:] - between[:, :-1]))
    return _repeated(step, q, steps)


def cavity_flow(nt, nit, u, v, dt, dx, dy, p, rho, nu):
    inner = (slice(1, -1), slice(1, -1))

    def sides(a):
        return a[1:-1, 2:], a[1:-1, :-2], a[2:, 1:-1], a[:-2, 1:-1]

    def moved(a, un, vn, gradient):
        east, west, north, south = sides(a)
        c = a[inner]
        return (c - un[inner] * dt / dx * (c - west) - vn[inner] * dt / dy * (c - south) - gradient
                + nu * (dt / dx ** 2 * (east - 2 * c + west) + dt / dy ** 2 * (north - 2 * c + south)))

    def step(state):
        u, v, p = state
        ue, uw, un_, us = sides(u)
        ve, vw, vn_, vs = sides(v)
        ux, uy, vx, vy = (ue - uw) / (2 * dx), (un_ - us) / (2 * dy), (ve - vw) / (2 * dx), (vn_ - vs) / (2 * dy)
        b = rho * (1 / dt * (ux + vy) - ux ** 2 - 2 * (uy * vx) - vy ** 2)

        def relaxed(p):
            e, w, n, s = sides(p)
            new = ((e + w) * dy ** 2 + (n + s) * dx ** 2 - dx ** 2 * dy ** 2 * b) / (2 * (dx ** 2 + dy ** 2))
            p = p.at[inner].set(new)
            p = p.at[:, -1].set(p[:, -2])
            p = p.at[0, :].set(p[1, :])
            p = p.at[:, 0].set(p[:, 1])
            return p.at[-1, :].set(0.0)
        p = _repeated(relaxed, p, nit)
        e, w, n, s = sides(p)
        new_u = moved(u, u, v, dt / (2 * rho * dx) * (e - w))
        new_v = moved(v, u, v, dt / (2 * rho * dy) * (n - s))
        u = u.at[inner].set(new_u).at[0, :].set(0.0).at[:, 0].set(0.0).at[:, -1].set(0.0).at[-1, :].set(1.0)
        return u, v.at[inner].set(new_v).at[0, :].set(0.0).at[-1, :].set(0.0).at[:, 0].set(0.0).at[:, -1].set(0.0), p
    return _repeated(step, (u, v, p), nt)
