"""The inputs that GradBench's evals send, made anew with their seeds; where they are files, random ones as large."""
from __future__ import annotations

from typing import Any

import numpy as np

SEED = 31337
Input = dict[str, Any]


def det(ell: int) -> Input:
    """A random matrix."""
    return {"A": _random(SEED).random_sample(ell * ell).tolist(), "ell": ell}


def llsq(n: int, m: int = 128) -> Input:
    """m random coefficients and n points."""
    return {"x": _random(SEED).random_sample(m).tolist(), "n": n}


def lse(n: int) -> Input:
    """A random vector."""
    return {"x": _random(SEED).random_sample(n).tolist()}


def ode(n: int, s: int) -> Input:
    """n random coefficients and s steps."""
    return {"x": _random(SEED).random_sample(n).tolist(), "s": s}


def kmeans(k: int, n: int, d: int) -> Input:
    """n random points, of which the last k are the centroids."""
    points = _random(SEED).random_sample((n, d)).tolist()
    return {"points": points, "centroids": points[-k:]}


def gmm(d: int, k: int, n: int = 1000, m: int = 0, gamma: float = 1.0) -> Input:
    """A mixture of k Gaussians with d dimensions, and n points."""
    rng = np.random.default_rng(SEED)
    x, mu, q, below = (draw(size=(rows, columns)).tolist() for draw, rows, columns in (
        (rng.normal, n, d), (rng.uniform, k, d), (rng.normal, k, d), (rng.normal, k, d * (d - 1) // 2)))
    return {"d": d, "k": k, "n": n, "x": x, "m": m, "gamma": gamma, "mu": mu, "q": q, "l": below,
            "alpha": rng.normal(size=k).tolist()}


def lstm(layers: int, c: int, b: int = 14) -> Input:
    """Parameters, a state and a sequence of c rows of b bits."""
    rng = np.random.default_rng(SEED)
    return {"main_params": rng.uniform(-1.0, 1.0, (2 * layers, 4 * b)).tolist(),
            "extra_params": rng.uniform(-1.0, 1.0, (3, b)).tolist(),
            "state": rng.uniform(-1.0, 1.0, (2 * layers, b)).tolist(),
            "sequence": rng.integers(0, 2, (c, b)).astype(float).tolist()}


def ba(n: int, m: int, p: int) -> Input:
    """n equal cameras, m equal points, p equal observations."""
    rng = np.random.default_rng(SEED)
    return {"n": n, "m": m, "p": p, "cam": rng.normal(size=11).tolist(), "x": rng.normal(size=3).tolist(),
            "w": float(rng.random()), "feat": rng.normal(size=2).tolist()}


def ht(vertices: int, points: int, in_triangles: bool) -> Input:
    """A hand of 22 bones in the order of ADBench's models: the wrist, five fingers of four bones, the forearm."""
    rng = np.random.default_rng(SEED)
    parents = [-1] + [0 if k % 4 == 0 else k for k in range(20)] + [0]
    weights = rng.random((vertices, 22))
    model = {"bone_count": 22, "bone_names": [f"bone{k}" for k in range(22)], "parents": parents,
             "base_relatives": rng.normal(size=(22, 4, 4)).tolist(),
             "inverse_base_absolutes": rng.normal(size=(22, 4, 4)).tolist(),
             "base_positions": np.hstack([rng.normal(size=(vertices, 3)), np.ones((vertices, 1))]).tolist(),
             "weights": (weights / weights.sum(axis=1, keepdims=True)).tolist(),
             "triangles": rng.integers(0, vertices, (2 * vertices, 3)).tolist(), "is_mirrored": False}
    corresponding = rng.integers(0, 2 * vertices if in_triangles else vertices, points).tolist()
    us = rng.random((points, 2)).tolist() if in_triangles else []
    return {"theta": rng.uniform(-0.5, 0.5, 26).tolist(), "us": us,
            "data": {"model": model, "correspondences": corresponding, "points": rng.normal(size=(points, 3)).tolist()}}


def _random(seed: int) -> np.random.RandomState:
    return np.random.RandomState(seed)
