"""A network of mass-action reactions in a row of cells with diffusion, by an implicit step with Newton's method."""
from collections import namedtuple

import numpy as np

Network = namedtuple("Network", "rates reactants products")


def rates_of(network, y):
    v = network.rates.copy()
    for r in range(v.size):
        for s in range(y.size):
            if network.reactants[r, s] > 0:
                v[r] *= y[s] ** network.reactants[r, s]
    return v


def source(network, y):
    return (network.products - network.reactants).T @ rates_of(network, y)


def jacobian(network, y):
    v = rates_of(network, y)
    change = network.products - network.reactants
    out = np.zeros((y.size, y.size))
    for r in range(v.size):
        for s in range(y.size):
            if network.reactants[r, s] > 0:
                out[:, s] += change[r] * (v[r] * network.reactants[r, s] / y[s])
    return out


def reaction_network(y, network, diffusion, dt, steps):
    """Concentrations (cells, species) advanced in place."""
    cells, species = y.shape
    for _ in range(steps):
        for c in range(cells):
            new = y[c].copy()
            for _ in range(4):
                mismatch = new - y[c] - dt * source(network, new)
                new -= np.linalg.solve(np.eye(species) - dt * jacobian(network, new), mismatch)
            y[c] = new
        y[1:-1] += dt * diffusion * (y[2:] - 2.0 * y[1:-1] + y[:-2])
