"""Programs of the simulation kind, unchanged, against differences and the dot product, under both engines."""
from __future__ import annotations

import numpy as np
import pytest

import s2sad
from tests.harness.derivatives import check_derivatives
from tests.harness.engines import running
from tests.harness.seeds import generator
from tests.simulations import (
    euler, finite_elements, kalman, lattice_boltzmann, level_set, multigrid, ray_march, reaction_network,
    shallow_water, wave,
)


def of_shallow_water(random):
    eta, u, v, depth = shallow_water.initial(5)
    return shallow_water.shallow_water, (eta, u + 0.01 * random.random(u.shape), v, depth, 0.3), \
        ("eta", "u", "depth", "drag"), ("eta", "u", "v", "return")


def of_wave(random):
    observed = 1e-4 * random.random((5, 3))
    receivers = np.array([1, 3, 4])
    return wave.wave, (1.0 + 0.2 * random.random((6, 6)), observed, (3, 2), receivers), ("c", "observed"), ("return",)


def of_euler(random):
    q = np.stack([1.0 + 0.5 * random.random(6), 0.3 * random.random(6), 2.5 + 0.5 * random.random(6)])
    return euler.euler, (q, 0.1, 0.01, 2), ("q",), ("q",)


def of_lattice_boltzmann(random):
    solid = np.zeros((4, 3), bool)
    solid[2, 1] = True
    f = lattice_boltzmann.W[:, None, None] * (1.0 + 0.1 * random.random((9, 4, 3)))
    return lattice_boltzmann.lattice_boltzmann, (f, 1.3, 0.1, solid, 2), ("f", "omega", "inflow"), ("f", "return")


def of_level_set(random):
    x = np.linspace(-0.6, 0.6, 5)
    phi = np.sqrt(x[:, None] ** 2 + 0.7 * x ** 2) - 0.35 + 0.05 * random.random((5, 5))
    return level_set.level_set, (phi, 0.6 + 0.1 * random.random((5, 5)), 0.05), ("phi", "speed", "tension"), ("return",)


def of_multigrid(random):
    return multigrid.multigrid, (np.zeros(9), random.random(9), 1.0 + random.random(9), 2), ("f", "k"), ("u", "return")


def of_finite_elements(random):
    nodes = np.array([[0.0, 0.0], [1.0, 0.1], [0.4, 1.0], [1.5, 1.1]]) + 0.1 * random.random((4, 2))
    bars = np.array([[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]])
    return finite_elements.truss, (nodes, bars, 0.5 + random.random(5), random.random(8), np.array([3, 4, 5, 6, 7])), \
        ("nodes", "areas", "load"), ("load", "return")


def of_kalman(random):
    f = np.array([[1.0, 0.1], [0.0, 1.0]])
    return kalman.kalman, (random.random(2), np.eye(2), f, random.random((1, 2)), 0.1 * np.eye(2), np.array([[0.3]]),
                           random.random((3, 1))), ("x", "P", "F", "H", "Q", "R"), ("x", "P", "return")


def of_ray_march(random):
    return ray_march.ray_march, (0.2 + random.random((3, 3, 3)), np.array([0.3, 0.5, -0.8]), np.zeros((2, 2)), 3), \
        ("grid", "light"), ("image", "return")


def of_reaction_network(random):
    reactants = np.array([[1, 1, 0], [0, 0, 2], [0, 1, 0]])
    products = np.array([[0, 0, 1], [1, 1, 0], [1, 0, 0]])
    network = reaction_network.Network(0.5 + random.random(3), reactants, products)
    return reaction_network.reaction_network, (0.5 + random.random((3, 3)), network, 0.2, 0.1, 1), \
        ("y", "network.rates", "diffusion"), ("y",)


PROGRAMS = (of_shallow_water, of_wave, of_euler, of_lattice_boltzmann, of_level_set, of_multigrid, of_finite_elements,
            of_kalman, of_ray_march)


@pytest.mark.parametrize(("program", "engine"), [*((p, e) for p in PROGRAMS for e in ("numpy", "loops")),
                                                 (of_wave, "numba"), (of_kalman, "numba")])
def test_program(program, engine):
    function, arguments, wrt, of = program(generator(8))
    check_derivatives(function, arguments, wrt, of, engine, coordinates=12)


@pytest.mark.parametrize("engine", ("numpy", "loops"))
def test_program_with_a_structure(engine):
    function, arguments, wrt, of = of_reaction_network(generator(8))
    with running(engine) as name:
        found = s2sad.check(function, *arguments, wrt=wrt, of=of, engine=name)
    assert found, str(found)
