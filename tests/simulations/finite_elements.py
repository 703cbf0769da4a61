"""Linear elasticity of a plane truss: elements assembled in loops, supports removed, solved; then its compliance."""
import numpy as np


def element(xi, xj, area, modulus):
    d = xj - xi
    length = np.sqrt(d @ d)
    c = d / length
    direction = np.concatenate((-c, c))
    return modulus * area / length * np.outer(direction, direction)


def assemble(nodes, bars, areas, modulus):
    n = 2 * nodes.shape[0]
    stiffness = np.zeros((n, n))
    for b in range(bars.shape[0]):
        i, j = bars[b]
        local = element(nodes[i], nodes[j], areas[b], modulus)
        places = np.array([2 * i, 2 * i + 1, 2 * j, 2 * j + 1])
        for p in range(4):
            for q in range(4):
                stiffness[places[p], places[q]] += local[p, q]
    return stiffness


def truss(nodes, bars, areas, load, free, modulus=1.0):
    """Compliance of the truss, with the displacements left in the loads' place for the free directions."""
    stiffness = assemble(nodes, bars, areas, modulus)
    reduced = np.zeros((free.size, free.size))
    for p in range(free.size):
        for q in range(free.size):
            reduced[p, q] = stiffness[free[p], free[q]]
    displacement = np.linalg.solve(reduced, load[free])
    compliance = load[free] @ displacement
    load[free] = displacement
    return compliance
