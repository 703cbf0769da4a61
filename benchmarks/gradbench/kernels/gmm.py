"""The log posterior of a mixture of Gaussians with a Wishart prior on the precisions."""
import math

import numpy as np


def logsumexp(v):
    """log(sum(exp(v))), without overflow."""
    largest = np.max(v)
    return largest + np.log(np.sum(np.exp(v - largest)))


def fill(factor, q, l):  # noqa: E741
    """Writes the lower triangular factor with diagonal exp(q) and l below it, column by column."""
    place = 0
    for j in range(q.size):
        factor[j, j] = np.exp(q[j])
        for i in range(j + 1, q.size):
            factor[i, j] = l[place + i - j - 1]
        place += q.size - j - 1


def log_density(x, mean, factor, logarithm, out):
    """Writes for each row of x the logarithm of a weighted Gaussian, up to a constant."""
    y = (x - mean) @ factor.T
    out[:] = logarithm - 0.5 * np.sum(y * y, axis=1)


def log_multigamma(a, d):
    """The logarithm of the multivariate gamma function."""
    total = 0.25 * d * (d - 1) * math.log(math.pi)
    for j in range(d):
        total += math.lgamma(a - 0.5 * j)
    return total


def objective(alpha, mu, q, l, x, gamma, m, sign):  # noqa: E741
    """The log posterior of x (n, d) for weights alpha (k), means mu (k, d), and factors of the precisions, lower
    triangular with diagonal exp(q) (k, d) and l (k, d (d - 1) / 2) below it, column by column; the prior's logarithm is
    multiplied by the sign."""
    n, d = x.shape
    terms = np.empty((alpha.size, n))
    factor = np.zeros((d, d))
    squares = 0.0
    for k in range(alpha.size):
        fill(factor, q[k], l[k])
        log_density(x, mu[k], factor, alpha[k] + np.sum(q[k]), terms[k])
        squares += np.sum(factor * factor)
    likelihood = -n * (0.5 * d * math.log(2.0 * math.pi) + logsumexp(alpha))
    for i in range(n):
        likelihood += logsumexp(terms[:, i])
    freedom = d + m + 1
    constant = freedom * d * (math.log(gamma) - 0.5 * math.log(2.0)) - log_multigamma(0.5 * freedom, d)
    prior = alpha.size * constant - 0.5 * gamma * gamma * squares + m * np.sum(q)
    return likelihood + sign * prior
