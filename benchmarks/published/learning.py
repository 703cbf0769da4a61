"""Statistics, layers of networks and dynamic programs, as NumPy users write them (NPBench, and the authors that are
named)."""
from __future__ import annotations

import numpy as np


def covariance(data):
    mean = np.mean(data, axis=0)
    data -= mean
    m = data.shape[1]
    cov = np.zeros((m, m))
    for i in range(m):
        cov[i:, i] = data[:, i] @ data[:, i:] / (data.shape[0] - 1.0)
        cov[i, i:] = cov[i:, i]
    return cov


def correlation(data):
    mean = np.mean(data, axis=0)
    stddev = np.std(data, axis=0)
    stddev[stddev <= 0.1] = 1.0
    data -= mean
    data /= np.sqrt(data.shape[0]) * stddev
    m = data.shape[1]
    corr = np.eye(m)
    for i in range(m - 1):
        corr[i + 1:, i] = data[:, i] @ data[:, i + 1:]
        corr[i, i + 1:] = corr[i + 1:, i]
    return corr


def azimint_naive(data, radius, npt):
    """The mean over rings of a detector's picture."""
    rmax = radius.max()
    res = np.zeros(npt)
    for i in range(npt):
        r1, r2 = rmax * i / npt, rmax * (i + 1) / npt
        mask = np.logical_and(r1 <= radius, radius < r2)
        res[i] = data[mask].mean()
    return res


def arc_distance(theta_1, phi_1, theta_2, phi_2):
    temp = np.sin((theta_2 - theta_1) / 2) ** 2 + np.cos(theta_1) * np.cos(theta_2) * np.sin((phi_2 - phi_1) / 2) ** 2
    return 2 * np.arctan2(np.sqrt(temp), np.sqrt(1 - temp))


def go_fast(a):
    trace = 0.0
    for i in range(a.shape[0]):
        trace += np.tanh(a[i, i])
    return a + trace


def softmax(x):
    tmp_max = np.max(x, axis=-1, keepdims=True)
    tmp_out = np.exp(x - tmp_max)
    return tmp_out / np.sum(tmp_out, axis=-1, keepdims=True)


def relu(x):
    return np.maximum(x, 0.0)


def mlp(x, w1, b1, w2, b2, w3, b3):
    h = relu(x @ w1 + b1)
    h = relu(h @ w2 + b2)
    return softmax(h @ w3 + b3)


def conv2d_bias(x, weights, bias):
    """A layer of a convolutional network: (N, H, W, C), no padding."""
    k = weights.shape[0]
    n, h, w = x.shape[0], x.shape[1] - k + 1, x.shape[2] - k + 1
    out = np.empty((n, h, w, weights.shape[3]))
    for i in range(h):
        for j in range(w):
            out[:, i, j, :] = np.sum(x[:, i:i + k, j:j + k, :, np.newaxis] * weights[np.newaxis, :, :, :],
                                     axis=(1, 2, 3))
    return out + bias


def batch_norm(x, gamma, beta):
    mean = np.mean(x, axis=0, keepdims=True)
    var = np.var(x, axis=0, keepdims=True)
    return gamma * (x - mean) / np.sqrt(var + 1e-5) + beta


def soft_dtw(D, gamma):
    """The smoothed cost of aligning two series (M. Cuturi, M. Blondel, ICML 2017)."""
    n, m = D.shape
    R = np.full((n + 1, m + 1), 1e10)
    R[0, 0] = 0.0
    for i in range(1, n + 1):
        for j in range(1, m + 1):
            a, b, c = -R[i - 1, j - 1] / gamma, -R[i - 1, j] / gamma, -R[i, j - 1] / gamma
            top = max(a, b, c)
            R[i, j] = D[i - 1, j - 1] - gamma * (np.log(np.exp(a - top) + np.exp(b - top) + np.exp(c - top)) + top)
    return R[n, m]


def hmm_forward(start, moves, emits, seen):
    """The log likelihood of a hidden Markov model, scaled at each step (L. Rabiner, 1989)."""
    alpha = start * emits[:, seen[0]]
    total = np.log(np.sum(alpha))
    alpha = alpha / np.sum(alpha)
    for t in range(1, seen.shape[0]):
        alpha = (alpha @ moves) * emits[:, seen[t]]
        scale = np.sum(alpha)
        total += np.log(scale)
        alpha = alpha / scale
    return total
