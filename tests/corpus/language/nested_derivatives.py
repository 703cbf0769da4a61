"""Derivatives that kernels call: forces of a potential, inner steps of a descent, products with a Hessian."""
from __future__ import annotations

import numpy as np

import s2sad
from tests.corpus import Case

X = np.array([0.2, 0.7, 0.4, 1.1])
STIFFNESS = np.array([1.0, 2.0, 0.5, 1.5])
SCALE = 0.7


# -- what is differentiated ----------------------------------------------------------------------------------------
def energy(x, k):
    total = 0.0
    for i in range(1, x.size):
        total += k * (x[i] - x[i - 1]) ** 4 + np.sin(x[i])
    return total


def by_arrays(x, k):
    return np.sum(np.exp(-k * x ** 2)) + np.dot(x[1:], x[:-1])


def from_outside(x):
    return SCALE * np.sum(STIFFNESS * x ** 3)


def springs(x, i, k):
    return k * (x[i] - x[i - 1]) ** 4


def with_a_helper(x, k):
    total = 0.0
    for i in range(1, x.size):
        total += springs(x, i, k) + np.cos(x[i])
    return total


def in_place(x, k):
    """Overwrites what it is given; its gradient does not."""
    for i in range(1, x.size):
        x[i] = x[i] * x[i - 1] + k
    return x[-1] ** 2


def with_branches(x, k):
    total = 0.0
    for i in range(x.size):
        if x[i] > k:
            total += (x[i] - k) ** 3
        else:
            total += x[i] ** 2 * k
    return total


def smoothed(du, u, c):
    for i in range(1, u.size - 1):
        du[i] = c * (u[i - 1] - 2.0 * u[i] + u[i + 1]) + u[i] ** 3


def until_small(x, k):
    y = x[0]
    while y > 0.1:
        y = y * (0.5 + 0.1 * k) * np.cos(y)
    return y * k


def of_a_matrix(a):
    return np.sum(a @ a) + np.sum(a ** 3)


force = s2sad.gradient(energy, "x")
compiled_force = s2sad.differentiate(energy, wrt="x")


# -- what differentiates -------------------------------------------------------------------------------------------
def norm_of_forces(x, k):
    f = force(x, k)
    return np.sum(f * f)


def of_a_name(x, k):
    f = s2sad.gradient(energy, "x")(x, k)
    return np.sum(f * f) * k


def of_a_position(x, k):
    return np.sum(s2sad.gradient(by_arrays, 0)(x, k) ** 3)


def as_in_jax(x, k):
    value, f = s2sad.value_and_grad(energy)(x, k)
    return np.sum(f * f) * s2sad.grad(energy, argnums=1)(x, k) + value


def of_a_differentiated_one(x, k):
    return np.sum(s2sad.gradient(compiled_force, "x")(x, k) ** 2)


def leapfrog(x, v, k):
    for _ in range(6):
        v -= 0.05 * force(x, k)
        x += 0.1 * v
    return np.sum(x * x)


def value_too(x, k):
    value, f = s2sad.value_and_gradient(energy, wrt="x")(x, k)
    return value * np.sum(f * f)


def of_a_number(x, k):
    slope = s2sad.gradient(energy, "k")(x, k)
    return slope * slope


def of_both(x, k):
    found = s2sad.gradient(energy, ("x", "k"))(x, k)
    return np.sum(found["x"] ** 2) * found["k"]


def by_keywords(x, k):
    return np.sum(s2sad.gradient(f=energy, wrt="x")(k=k, x=x) ** 2)


def along(x, k):
    h = s2sad.hvp(energy, (x, k), {"x": np.cos(x)})
    return np.sum(h * x)


def mixed(x, k):
    return np.sum(s2sad.hvp(by_arrays, (x, k), {"k": k * k}, wrt="x") ** 2)


def weighted(x, k):
    found = s2sad.vjp(energy, (x, k), {"return": k * k}, wrt=("x", "k"))
    return np.sum(found["x"] ** 2) * found["k"]


def tangents(x, k):
    return s2sad.jvp(energy, (x, k), {"x": x * x, "k": 2.0})["return"] ** 2


def of_a_written_array(x, k):
    du = np.zeros_like(x)
    pulled = s2sad.vjp(smoothed, (du, x, k), {"du": x * x}, wrt="u")
    pushed = s2sad.jvp(smoothed, (du, x, k), {"u": x * x, "c": 1.0}, of="du")
    return np.sum(pulled["u"] * x) + np.sum(pushed["du"] ** 2)


def of_outside(x):
    return np.sum(s2sad.gradient(from_outside)(x) ** 2)


def of_helpers(x, k):
    return np.sum(s2sad.gradient(with_a_helper, "x")(x, k) ** 2)


def along_several(x, k):
    """One product with a Hessian is written into an array that there is, another one is a value."""
    d = np.ones(4)
    for _ in range(2):
        h = s2sad.hvp(energy, (x, k), {"x": d})
        d = h / np.sqrt(np.sum(h * h))
    return np.sum(d * s2sad.hvp(energy, (x, k), {"x": d}))


def of_what_writes(x, k):
    g = s2sad.gradient(in_place, "x")(x, k)
    return np.sum(g * x)


def of_branches(x, k):
    return np.sum(s2sad.gradient(with_branches, "x")(x, k) ** 2)


def of_a_while_loop(x, k):
    return s2sad.gradient(until_small, "k")(x, k) * np.sum(x)


def of_matrices(x, k):
    return np.sum(s2sad.gradient(of_a_matrix)(np.outer(x, x) * k) ** 2)


def in_a_branch(x, k):
    total = np.sum(x)
    for i in range(3):
        if total > 2.0 * i:
            total += np.sum(force(x, k)) * 0.1
        else:
            total -= 0.2 * x[0]
    return total


def in_a_helper(x, k):
    return stepped(stepped(x, k), 0.5 * k)[1]


def stepped(x, k):
    return x - 0.1 * force(x, k)


def third(x, k):
    return np.sum(np.sin(s2sad.gradient(norm_of_forces, "x")(x, k)))


def argument_afterwards(x, k):
    """The gradient is taken at what the argument was then."""
    g = force(x, k)
    x *= 2.0
    return np.sum(g * x)


# -- the particle of GradBench: a charge falls past two others, whose potential's gradient accelerates it -------------
def potential(x, charges):
    total = 0.0
    for c in range(charges.shape[0]):
        total += 1.0 / np.sqrt((x[0] - charges[c, 0]) ** 2 + (x[1] - charges[c, 1]) ** 2)
    return total


def particle(w):
    charges = np.array([[10.0, 10.0 - w], [10.0, 0.0]])
    dt = 0.1
    x, v = np.array([0.0, 8.0]), np.array([0.75, 0.0])
    while True:
        a = -s2sad.gradient(potential, "x")(x, charges)
        moved = x + dt * v
        if moved[1] <= 0.0:
            break
        x = moved
        v = v + dt * a
    stop = -x[1] / v[1]
    return (x[0] + stop * v[0]) ** 2


def particle_by_tangents(w):
    charges = np.array([[10.0, 10.0 - w], [10.0, 0.0]])
    dt = 0.1
    x, v, a = np.array([0.0, 8.0]), np.array([0.75, 0.0]), np.zeros(2)
    while True:
        for c in range(2):
            e = np.zeros(2)
            e[c] = 1.0
            a[c] = -s2sad.jvp(potential, (x, charges), {"x": e})["return"]
        moved = x + dt * v
        if moved[1] <= 0.0:
            break
        x = moved
        v = v + dt * a
    stop = -x[1] / v[1]
    return (x[0] + stop * v[0]) ** 2


def twice(a, b, k):
    return np.sum(k * a ** 2 * b)


def products(a, b):
    return a * b[0] + a[0] * b ** 2


products_by_numpy = s2sad.differentiate(products, engine="numpy")      # Python asks for its matrix, too


def of_one_given_twice(x, k):
    g = s2sad.gradient(twice, "a")(x, x, k)
    x[0] = x[1] * k
    return np.sum(g * x) + np.sum(s2sad.vjp(twice, (x, x, k), {"return": k}, wrt=("b", "a"))["b"] ** 2)


def along_one_given_twice(x, k):
    along = s2sad.jvp(products, (x, x), {"a": x, "b": np.cos(x)})["return"]
    J = s2sad.jacobian(products_by_numpy, wrt="b")(b=x, a=x)
    return np.sum(along) * k + np.sum(J @ s2sad.hvp(twice, (x, x, k), {"a": x}))


def power(a, b):
    return a ** 2 * b


def of_one_number_given_twice(x, k):
    return np.sum(x) * s2sad.gradient(power, "b")(k, k) + s2sad.gradient(power, "a")(x[0], x[0])


def summed(a, b):
    t = 0.0
    for i in range(a.size):
        t += a[i] ** 2 * b[i]
    return t


def of_one_given_twice_in_a_loop(x, k):
    return np.sum(s2sad.gradient(summed, "a")(x, x) * x) * k + np.sum(s2sad.gradient(summed, "b")(x, x) * x)


# -- refused ---------------------------------------------------------------------------------------------------------
def of_what_is_no_float(x, k):
    return np.sum(s2sad.gradient(smoothed, "u")(np.zeros(4), x, k))


def of_several(x, k):
    return np.sum(s2sad.gradient(energy)(x, k)["x"])


def of_no_parameter(x, k):
    return np.sum(s2sad.gradient(energy, "y")(x, k))


def of_a_library(x, k):
    return np.sum(s2sad.gradient(np.dot, "a")(x, x))


def swallowing(a, b):
    for i in range(a.size):
        a[i] = a[i] * b[i]
    return np.sum(a)


def begun_as_its_own(a, b):
    t = 0.0
    if b[0] > 0.0:
        t = a
    t += b
    return np.sum(t * b)


def of_one_that_is_written_by_another_name(x, k):
    return np.sum(s2sad.gradient(begun_as_its_own, "a")(x, x)) * k


def of_one_that_is_written_as_well(x, k):
    return np.sum(s2sad.gradient(swallowing, "a")(x, x)) * k


def with_options(x, k):
    return s2sad.vjp(energy, (x, k), {"return": 1.0}, wrt="k", checkpoint={"i": 2})["k"]


def cases():
    both = [
        norm_of_forces, of_a_name, of_a_position, of_a_differentiated_one, value_too, of_a_number, of_both,
        as_in_jax, by_keywords, along, mixed, weighted, tangents, of_a_written_array, of_helpers, of_what_writes,
        of_branches, of_matrices, in_a_branch, in_a_helper, third, argument_afterwards,
        of_one_given_twice, of_one_given_twice_in_a_loop, along_one_given_twice, of_one_number_given_twice]
    for kernel in both:
        yield Case(kernel, (X.copy(), 1.3), ("x", "k"))
    yield Case(leapfrog, (X.copy(), np.zeros(4), 1.3), ("x", "v", "k"), ("return", "x", "v"))
    yield Case(along_several, (X.copy(), 1.3), ("x", "k"), options={"coordinates": 2, "directions": 1})
    yield Case(of_outside, (X.copy(),), "x")
    yield Case(of_a_while_loop, (X.copy(), 1.3), ("x", "k"))
    yield Case(particle, (0.3,), "w")
    yield Case(particle_by_tangents, (0.3,), "w")
    here, advice = "is no array or number of", "give it as an argument of its own, np.copy(x)"
    for kernel, refused in (
            (of_what_is_no_float, "S201 at `s2sad.gradient(smoothed, \"u\")(np.zeros(4), x, k)`: the derivative of "
             "what 'smoothed' returns: it is not one value that it computes: let it return the one float or "
             "array that is meant"),
            (of_several, "S201 at `s2sad.gradient(energy)(x, k)`: 'energy' takes several arguments: say what the "
             "derivative is with respect to: wrt=\"x\""),
            (of_no_parameter, f"S201 at `s2sad.gradient(energy, \"y\")(x, k)`: 'y' {here} 'energy' that it reads and "
             f"that is given by itself: {advice}"),
            (of_a_library, "S201 at `s2sad.gradient(np.dot, \"a\")(x, x)`: the derivative of a function of a "
             "library: give a function that can be read"),
            (of_one_that_is_written_as_well, f"S201 at `s2sad.gradient(swallowing, \"a\")(x, x)`: 'a' {here} "
             f"'swallowing' that it reads and that is given by itself: {advice}"),
            (of_one_that_is_written_by_another_name, "S201 at `s2sad.gradient(begun_as_its_own, \"a\")(x, x)`: 'a' "
             f"{here} 'begun_as_its_own' that it reads and that is given by itself: {advice}"),
            (with_options, "S201 at `s2sad.vjp(energy, (x, k), {\"return\": 1.0}, wrt=\"k\", checkpoint={\"i\": 2})`: "
             "'checkpoint' of s2sad.vjp is not supported in a kernel: leave it out: the loops of what is "
             "differentiated record")):
        yield Case(kernel, (X.copy(), 1.3), refused=refused)
