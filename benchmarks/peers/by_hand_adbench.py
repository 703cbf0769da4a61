"""Adjoints by hand of ADBench's kernels. The mixture's needs three moments of the points, weighted by what falls to
each component, and works in blocks of points that stay in the cache; the LSTM's records what each cell computes."""
from __future__ import annotations

from typing import Any

import numpy as np

BLOCK = 64


def gmm(alpha, alpha_bar, mu, mu_bar, q, q_bar, l, l_bar, x, gamma, m, sign, seed):  # noqa: E741
    (n, d), k = x.shape, alpha.size
    block = min(BLOCK, n)
    factor, start, shares = factors(q, l), np.empty(k), np.empty(k)
    sums = np.zeros((k, block))
    firsts, seconds = np.zeros((k, d, block)), np.zeros((k, d, d, block))
    centred, y, terms = np.zeros((k, d, block)), np.empty(block), np.empty((k, block))
    for c in range(k):
        start[c] = alpha[c] + np.sum(q[c])
    for first in range(0, n, block):
        size = min(block, n - first)
        for c in range(k):
            for p in range(size):
                for j in range(d):
                    centred[c, j, p] = x[first + p, j] - mu[c, j]
            log_density(centred[c], factor[c], start[c], y, terms[c])
        softmax(terms)
        terms[:, size:] = 0.0
        for c in range(k):
            moments(centred[c], terms[c], y, sums[c], firsts[c], seconds[c])
    for c in range(k):
        shares[c] = np.sum(sums[c])
        alpha_bar[c] += seed * shares[c]
        component_back(mu_bar[c], q_bar[c], l_bar[c], factor[c], shares[c], firsts[c], seconds[c], gamma, m, sign, seed)
    weight = np.exp(alpha - np.max(alpha))
    alpha_bar -= seed * n * weight / np.sum(weight)


def factors(q, l):  # noqa: E741
    k, d = q.shape
    factor = np.zeros((k, d, d))
    for c in range(k):
        place = 0
        for j in range(d):
            factor[c, j, j] = np.exp(q[c, j])
            for i in range(j + 1, d):
                factor[c, i, j] = l[c, place]
                place += 1
    return factor


def log_density(centred, factor, start, y, out):
    out[:] = start
    for i in range(factor.shape[0]):
        y[:] = 0.0
        for j in range(i + 1):
            along = factor[i, j]
            for p in range(y.size):
                y[p] += along * centred[j, p]
        for p in range(y.size):
            out[p] -= 0.5 * y[p] * y[p]


def softmax(terms):
    k, size = terms.shape
    largest, total = terms[0].copy(), np.zeros(size)
    for c in range(1, k):
        for p in range(size):
            largest[p] = max(largest[p], terms[c, p])
    for c in range(k):
        for p in range(size):
            terms[c, p] = np.exp(terms[c, p] - largest[p])
            total[p] += terms[c, p]
    for c in range(k):
        for p in range(size):
            terms[c, p] /= total[p]


def moments(centred, weight, weighted, sums, firsts, seconds):
    for p in range(weight.size):
        sums[p] += weight[p]
    for i in range(centred.shape[0]):
        for p in range(weight.size):
            weighted[p] = weight[p] * centred[i, p]
            firsts[i, p] += weighted[p]
        for j in range(i + 1):
            for p in range(weight.size):
                seconds[i, j, p] += weighted[p] * centred[j, p]


def component_back(mu_bar, q_bar, l_bar, factor, share, firsts, seconds, gamma, m, sign, seed):
    d, place = mu_bar.size, 0
    first, second, mean_bar = np.empty(d), np.empty((d, d)), np.zeros(d)
    for i in range(d):
        first[i] = np.sum(firsts[i])
        for j in range(i + 1):
            second[i, j] = second[j, i] = np.sum(seconds[i, j])
    for i in range(d):
        along = 0.0
        for j in range(i + 1):
            along += factor[i, j] * first[j]
        for j in range(i + 1):
            mean_bar[j] += factor[i, j] * along
    for j in range(d):
        mu_bar[j] += seed * mean_bar[j]
        for i in range(j, d):
            of_factor = sign * gamma * gamma * factor[i, j]
            for r in range(i + 1):
                of_factor += factor[i, r] * second[r, j]
            if i == j:
                q_bar[j] += seed * (share + sign * m - of_factor * factor[j, j])
            else:
                l_bar[place] -= seed * of_factor
                place += 1


FORGET, INGATE, OUTGATE, CHANGE, BENT, BEFORE = range(6)


def lstm(main_params, main_params_bar, extra_params, extra_params_bar, state, sequence, seed):
    (c, b), layers = sequence.shape, state.shape[0] // 2
    kept, hidden = np.empty((c - 1, layers, 6, b)), np.empty((c, layers, b))
    outputs, x = np.empty((c - 1, b)), np.empty(b)
    cell, hidden[0] = state[1::2].copy(), state[::2]
    for t in range(c - 1):
        for i in range(b):
            x[i] = sequence[t, i] * extra_params[0, i]
        for k in range(layers):
            layer(main_params[2 * k], main_params[2 * k + 1], hidden[t, k], cell[k], x, kept[t, k], hidden[t + 1, k])
        for i in range(b):
            outputs[t, i] = np.exp(x[i] * extra_params[1, i] + extra_params[2, i])
    scale = -seed / (b * (c - 1))
    x_bar, hidden_bar, cell_bar = np.empty(b), np.zeros((layers, b)), np.zeros((layers, b))
    for t in range(c - 2, -1, -1):
        given, total = 0.0, 2.0
        for i in range(b):
            given += sequence[t + 1, i]
            total += outputs[t, i]
        for i in range(b):
            of_output = scale * (sequence[t + 1, i] - given * outputs[t, i] / total)
            extra_params_bar[1, i] += of_output * hidden[t + 1, layers - 1, i]
            extra_params_bar[2, i] += of_output
            x_bar[i] = of_output * extra_params[1, i]
        for k in range(layers - 1, 0, -1):
            layer_back(main_params[2 * k], main_params_bar[2 * k], main_params_bar[2 * k + 1], hidden[t, k],
                       hidden_bar[k], cell_bar[k], hidden[t + 1, k - 1], x_bar, kept[t, k])
        for i in range(b):
            x[i] = sequence[t, i] * extra_params[0, i]
        layer_back(main_params[0], main_params_bar[0], main_params_bar[1], hidden[t, 0], hidden_bar[0], cell_bar[0],
                   x, x_bar, kept[t, 0])
        for i in range(b):
            extra_params_bar[0, i] += sequence[t, i] * x_bar[i]


def sigmoid(x):
    return 1.0 / (1.0 + np.exp(-x))


def layer(weight, bias, hidden, cell, x, kept, out):
    b = x.size
    for i in range(b):
        kept[BEFORE, i] = cell[i]
        kept[FORGET, i] = sigmoid(x[i] * weight[i] + bias[i])
        kept[INGATE, i] = sigmoid(hidden[i] * weight[b + i] + bias[b + i])
        kept[OUTGATE, i] = sigmoid(x[i] * weight[2 * b + i] + bias[2 * b + i])
        kept[CHANGE, i] = np.tanh(hidden[i] * weight[3 * b + i] + bias[3 * b + i])
        cell[i] = cell[i] * kept[FORGET, i] + kept[INGATE, i] * kept[CHANGE, i]
        kept[BENT, i] = np.tanh(cell[i])
        x[i] = out[i] = kept[OUTGATE, i] * kept[BENT, i]


def layer_back(weight, weight_bar, bias_bar, hidden, hidden_bar, cell_bar, x, x_bar, kept):
    b = x.size
    for i in range(b):
        forget, ingate, outgate = kept[FORGET, i], kept[INGATE, i], kept[OUTGATE, i]
        change, bent, seed = kept[CHANGE, i], kept[BENT, i], hidden_bar[i] + x_bar[i]
        of_cell = cell_bar[i] + seed * outgate * (1.0 - bent * bent)
        of_forget = of_cell * kept[BEFORE, i] * forget * (1.0 - forget)
        of_ingate = of_cell * change * ingate * (1.0 - ingate)
        of_outgate = seed * bent * outgate * (1.0 - outgate)
        of_change = of_cell * ingate * (1.0 - change * change)
        bias_bar[i] += of_forget
        bias_bar[b + i] += of_ingate
        bias_bar[2 * b + i] += of_outgate
        bias_bar[3 * b + i] += of_change
        weight_bar[i] += of_forget * x[i]
        weight_bar[b + i] += of_ingate * hidden[i]
        weight_bar[2 * b + i] += of_outgate * x[i]
        weight_bar[3 * b + i] += of_change * hidden[i]
        cell_bar[i] = of_cell * forget
        hidden_bar[i] = of_ingate * weight[b + i] + of_change * weight[3 * b + i]
        x_bar[i] = of_forget * weight[i] + of_outgate * weight[2 * b + i]


KERNELS: dict[str, Any] = {f.__name__: f for f in (gmm, lstm)}
