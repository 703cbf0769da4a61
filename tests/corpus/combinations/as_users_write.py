"""Kernels as people bring them: each holds several things that were once refused, or differentiated wrongly."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

NODES, WEIGHTS = (-0.6, 0.6), [1.0, 0.5]
STAGES = ((0.5, 0.25), (0.1, 0.2))


def values(*shape, seed=1):
    return generator(seed).uniform(0.5, 1.5, shape)


def flux(q, gamma=1.4, speeds=(1.0, 2.0)):
    """A function that stacks rows, with a tuple for a default."""
    rho, m = q
    return np.array([m * speeds[0], m * m / rho + gamma * rho]), speeds[1] * m


def stacks(q, r):
    f, c = flux(q)
    left, right = f[:, :-1], f[:, 1:]
    q[:, 1:-1] -= 0.1 * (right - left)[:, :-1]
    q[:] = [q[0] + c, 2.0 * q[1]]
    found = []
    for k in range(2):
        found.append(np.array([r, k * r * r]))
    found = np.array(found)
    return np.sum(np.array([[r, r * r], [r, r]]) ** 2) + np.sum(found[1])


def renamed(x, y):
    """Names that hold one thing after another, which no path confuses."""
    r = x - y
    r = np.sum(r * r)
    for _ in range(2):
        m = x * y
        m = m.mean()
        x = x * m
    m = x[None, :] * y[:, None]
    if r > 0.5:
        t = y * 2.0
        r = r + t[0]
    else:
        t = 2
        r = r * t
    y = y.sum()
    return np.sum(m) * r * y


def spelled(x, tol, weights=(1.0, 2.0)):
    """Assignments inside expressions, texts of errors, constants that are tuples and lists."""
    if (n := len(x)) > 2 and n < 100:
        x[0] = 2.0 * x[1]
    it = 0
    while (r := np.sqrt(np.sum(x * x))) > tol:
        x *= 0.7
        if (k := it % 3) == 0:
            it += 2
            continue
        if (m := k + 1) > 50:
            raise ValueError(f"too many at {it}: {r:.3e} and {x[0]!r}, {m}")
        it += 1
    assert it < 1000, f"at {it}"
    total = 0.0
    for node, weight, (a, b) in zip(NODES, WEIGHTS, STAGES):
        total += weight * x[0] ** 2 * (node + a * b)
    for k in range(len(NODES)):
        total += NODES[k] * weights[k] * x[k]
    del it
    return total * r


def normalised(q, n):
    """Arrays that a loop binds anew and then writes in place: none is the caller's."""
    fallen = np.sum(q * q)
    best = q
    for k in range(n):
        q = q + 0.1 * q * q
        q /= np.linalg.norm(q)
        trial = best * (0.7 + 0.1 * k)
        trial[0] += 0.05
        found = np.sum(trial ** 2)
        if found < fallen:
            best = trial
            fallen = found
        p = q
        if q[0] > 0.2:
            q = q * 2.0
            q -= 0.5 * p
    return q * fallen + best


def picked(x, idx):
    """Integer arrays that are clipped, joined and crossed; shapes as arrays; what a tuple's variable item is."""
    size = np.array(x.shape)
    at = np.clip(np.floor(x[:, 0]).astype(int), 0, size[0] - 2)[:2]
    a = np.r_[0.0, x[0], x[at[0], 1] * 2]
    b = np.c_[x[:, 0], x[:, 1] ** 2]
    k = np.zeros((3, 3))
    k[np.ix_(idx, np.r_[0:2, 2])] += x[:3] * x[1]
    k[np.ix_([0, 1], [1, 2])] *= 2.0
    history = [(a[1], b[0, 0])]
    for i in range(3):
        history.append((a[i] * k[i, i], (1.0, 2.0, 4.0)[i] * b[i, 1]))
    return np.sum(np.array(history)) + np.sum(k[np.ix_(idx[:2], idx[1:])] ** 2)


def relaxed(u, f, n):
    v = u.copy()
    for _ in range(n):
        v[1:-1] = 0.5 * (u[:-2] + u[2:]) + f[1:-1]
        u, v = v, u
    return u


def turns(p, old, f, n):
    """Arrays of the caller's that take turns with others: what each holds in the end depends on how many there were."""
    new = np.zeros_like(p)
    for k in range(n):
        for i in range(1, p.size - 1):
            new[i] = 2.0 * p[i] - old[i] + 0.1 * f[i] * (p[i + 1] - 2.0 * p[i] + p[i - 1])
        old, p, new = p, new, old
        if np.sum(p) > 100.0 * k + 50.0:
            break
    p[0] += f[0] * old[1]
    r = relaxed(f, new, n)
    return p, np.sum(r * p)


def summed(x, w):
    """A sum over iterations that run again in the reverse sweep."""
    e = 0.5
    for p in range(x.shape[0]):
        r2 = 0.0
        for c in range(3):
            r2 += x[p, c] ** 2
        s6 = (w / r2) ** 3
        e += 4.0 * w * (s6 * s6 - s6)
    return e


def described(x):
    """Bounds on one side, and functions of whole arrays inside an array that is spelled."""
    np.clip(x, 0.6, None, out=x)
    a = np.clip(x, None, 0.9) + x.clip(0.7, None) + np.clip(x, a_min=0.5, a_max=1.0) + x.clip(max=0.8)
    out = np.zeros((2, 3))
    for i in range(2):
        out[i] = a.mean(), x[i:].std(), np.median(x) * 2
        out[i, 1:] += [np.dot(a, x), np.linalg.norm(x)]
    return np.array([np.mean(a), a @ x, np.sort(a)[0]]) @ out.T


def chosen(x):
    """A choice of arrays inside a sum that is returned; parts with a diagonal; the largest of a row."""
    a = x[:3, :3]
    scale = np.trace(a[:2, :2]) + np.diag(a[1:, 1:]).sum() + max(x[0]) + min((x[1, 0], x[1, 1], x[2, 0]))
    scale += sum(x[1]) + sum(x[1:, 0] ** 2) * sum((x[0, 0], x[0, 1])) + sum(x)[2] + sum(v * v for v in x[3])
    return scale * np.sum(np.where(x < 0.8, x * x, 0.5)) + float(np.sum(np.where(x > 1.0, x, 0.0)))


def single(x, th, n):
    """float32 arrays that meet float64 ones under one name."""
    turn = np.eye(2)
    for j in range(n):
        c, s = np.cos(th[j]), np.sin(th[j])
        if j % 2 == 0:
            r = np.array([[c, -s], [s, c]])
        else:
            r = np.array([[1, 0], [s, 1.0]])
        turn = turn @ r
        x = x + 0.1 * np.linalg.solve(np.eye(3) * 2.0, x)
        x[0] *= 0.5
    return turn.sum() * x.sum()


CASES = [(chosen, (values(4, 3),), ("return",)),
         (described, (values(4),), ("x", "return")),
         (summed, (values(3, 3), 0.7), ("return",)),
         (single, (values(3).astype(np.float32), values(3, seed=2).astype(np.float32), 3), ("return",)),
         *[(turns, (values(5), values(5, seed=2), values(5, seed=3), n), ("p", "old", "f", "return"))
           for n in (4, 3, 0)],
         (normalised, (values(3), 3), ("return",)),
         (picked, (values(4, 3), np.array([0, 2, 1])), ("return",)),
         (stacks, (values(2, 5), values(3, seed=2)), ("q", "return")),
         (renamed, (values(3), values(3, seed=2)), ("return",)),
         (spelled, (values(4), 0.3), ("x", "return"))]


def flat_store(x):
    y = np.zeros((2, 2))
    y.flat[:] = x
    return y[0, 0] * y[1, 1]


def flat_store_at_an_ellipsis(x):
    y = np.zeros((2, 2))
    y.flat[...] = x
    return y[0, 0] * y[1, 1]


def cases():
    yield Case(flat_store, (np.arange(1.0, 5.0),), "x")
    # attribute of an array is refused
    yield Case(flat_store_at_an_ellipsis, (np.ones(4),), refused=(
        "S201 at `y.flat`: the attribute 'flat' of an array: write it with the array itself: x[i, j], "
        "x[...], x.shape, x.size"))
    # kernel
    for kernel, arguments, outputs in CASES:
        code = kernel.__code__
        inputs = tuple((n for n, a in zip(code.co_varnames, arguments) if np.asarray(a).dtype.kind == "f"))
        yield Case(kernel, arguments, inputs, outputs)
