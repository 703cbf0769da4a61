"""Jacobians that kernels call: Newton's method, and derivatives of what is computed of a Jacobian; the same derivative
called with arguments of several types."""
from __future__ import annotations

import numpy as np

import s2sad
from tests.corpus import Case

X = np.array([0.4, 0.7, 0.5])
P = np.array([1.0, 2.0, 3.0])


# -- what is differentiated ----------------------------------------------------------------------------------------
def residual(u, p):
    r = np.zeros(u.size)
    for i in range(u.size):
        r[i] = u[i] ** 3 + p[i] * u[i] - 1.0
        if i > 0:
            r[i] += 0.3 * np.sin(u[i - 1])
    return r


def rates(du, u, k):
    for i in range(u.size):
        du[i] = -k * u[i] * u[i - 1]


def running(u, k):
    """Overwrites what it is given; its Jacobian does not."""
    for i in range(1, u.size):
        u[i] = u[i] * u[i - 1] + k
    return u * u


def of_two_axes(a, k):
    return np.array([np.sum(a ** 2) * k, a[0, 1] * a[1, 0], np.sin(a[1, 1])])


def product(a, x):
    return np.outer(a @ x, x)


def total(u, k):
    return np.sum(np.sin(u) * k)


def circle(t):
    return np.array([np.cos(t), np.sin(2.0 * t)])


def cubed(t):
    return t ** 3


def pull(x, k):
    return -s2sad.gradient(total, "u")(x, k)


# where Python runs a kernel its Jacobians are NumPy's: what they emit is not what the kernel's derivatives do
residual_by_numpy = s2sad.differentiate(residual, engine="numpy")
rates_by_numpy = s2sad.differentiate(rates, engine="numpy")
running_by_numpy = s2sad.differentiate(running, engine="numpy")
of_two_axes_by_numpy = s2sad.differentiate(of_two_axes, engine="numpy")
product_by_numpy = s2sad.differentiate(product, engine="numpy")
total_by_numpy = s2sad.differentiate(total, engine="numpy")
circle_by_numpy = s2sad.differentiate(circle, engine="numpy")
cubed_by_numpy = s2sad.differentiate(cubed, engine="numpy")
pull_by_numpy = s2sad.differentiate(pull, engine="numpy")


# -- what differentiates -------------------------------------------------------------------------------------------
def newton(u, p):
    for _ in range(6):
        J = s2sad.jacobian(residual_by_numpy, wrt="u")(u, p)
        u = u - np.linalg.solve(J, residual(u, p))
    return u


def newton_until_small(u, p):
    """With a test, and one Jacobian for several steps."""
    r = residual(u, p)
    while np.max(np.abs(r)) > 1e-10:
        J = s2sad.jacobian(residual_by_numpy, "u")(u, p)
        for _ in range(2):
            u = u - np.linalg.solve(J, r)
            r = residual(u, p)
    return np.sum(u * p)


def implicit_steps(u, k, dt, steps):
    """The backward method of Euler, whose right-hand side writes its rate."""
    du, eye = np.zeros_like(u), np.eye(u.size)
    for _ in range(steps):
        v = u.copy()
        for _ in range(3):
            rates(du, v, k)
            J = s2sad.jacobian(rates_by_numpy, wrt="u", of="du")(du, v, k)
            v = v - np.linalg.solve(eye - dt * J, v - u - dt * du)
        u = v
    return u


def of_what_writes(x, k):
    J = s2sad.jacobian(running_by_numpy, "u", "return")(x, k)
    return np.sum(J ** 2) + np.sum(x)


def by_rows(x, k):
    J = s2sad.jacobian(running_by_numpy, "u", "return", mode="reverse")(x, k)
    return np.sum(J[1] * x) + np.sum(J[:, 0] ** 2)


def by_rows_of_a_written_array(x, k):
    J = s2sad.jacobian(rates_by_numpy, wrt="u", of="du", mode="reverse")(np.zeros(3), x, k)
    return np.linalg.det(J + np.eye(3))


def of_a_matrix(x, k):
    J = s2sad.jacobian(of_two_axes_by_numpy, wrt="a")(np.outer(x, x)[:2, :2], k)
    return np.sum(J[0] * J[1]) + J[2, 1, 1]


def to_a_matrix(x, k):
    J = s2sad.jacobian(product_by_numpy, wrt="x", mode="forward")(np.outer(x, x) * k, x)
    return np.sum(J[:, :, 1] * x)


def of_a_number(x, k):
    return np.sum(s2sad.jacobian(total_by_numpy, wrt="u")(x, k) * x)


def by_a_number(x, k):
    return np.dot(s2sad.jacobian(circle_by_numpy)(k), x[:2])


def of_and_by_numbers(x, k):
    return s2sad.jacobian(cubed_by_numpy)(k * x[0])


def of_a_position(x, k):
    return np.sum(s2sad.jacobian(rates_by_numpy, 1, "du")(np.zeros(3), x, k) * np.outer(x, P))


def trace_of_steps(x, k):
    for _ in range(3):
        x = x + 0.1 * np.diag(s2sad.jacobian(residual_by_numpy, "u")(x, k * P))
    return np.sum(x)


def of_what_was_there(x, k):
    """Of an array that is written with respect to what it held, by columns and by rows."""
    J = s2sad.jacobian(running_by_numpy, "u", "u")(x, k)
    K = s2sad.jacobian(running_by_numpy, "u", "u", mode="reverse")(x * x, k)
    return np.sum(J * x) + np.sum(K @ J)


def hessian_of_a_gradient(x, k):
    """The Jacobian of a function that calls a gradient."""
    return np.sum(s2sad.jacobian(pull_by_numpy, "x")(x, k) ** 2)


# -- one derivative for several types ------------------------------------------------------------------------------
def of_several_types(x, k):
    a = s2sad.gradient(total, "u")(x, k)
    b = s2sad.gradient(total, "u")(np.outer(x, x), k)
    c = s2sad.gradient(total, "u")(np.outer(x, x), x)
    d = s2sad.gradient(total, "u")(k * k, k)
    return np.sum(a * a) + np.sum(b * b * b) + np.sum(c) + d * np.sum(a)


def jacobians_of_several_types(x, k):
    J = s2sad.jacobian(total_by_numpy, "u")(x, k)
    return np.sum(J * x) + s2sad.jacobian(total_by_numpy, "u")(k * k, k) + np.sum(s2sad.jacobian(total_by_numpy, "u")(
        np.outer(x, x), k) ** 2)


# -- refused -------------------------------------------------------------------------------------------------------
def sparse(x, p):
    return np.sum(s2sad.jacobian(residual, "u", sparse=True)(x, p))


def several(x, p):
    return np.sum(s2sad.jacobian(residual, ("u", "p"))(x, p))


def unnamed(x, p):
    return np.sum(s2sad.jacobian(residual)(x, p))


def of_nothing(x, p):
    return np.sum(s2sad.jacobian(rates, "u")(np.zeros(3), x, 1.0))


def of_no_mode(x, p):
    return np.sum(s2sad.jacobian(residual, "u", mode="sideways")(x, p))


def of_complex_numbers(x, p):
    return np.sum(np.abs(s2sad.jacobian(total, "u")(x * 1j, 1.0)))


def cases():
    yield Case(newton, (X.copy(), P.copy()), "p")
    yield Case(newton_until_small, (X.copy(), P.copy()), "p")
    yield Case(implicit_steps, (X.copy(), 1.3, 0.2, 3), ("u", "k", "dt"))
    for kernel in (of_what_writes, by_rows, by_rows_of_a_written_array, of_a_matrix, to_a_matrix, of_a_number,
                   by_a_number, of_and_by_numbers, of_a_position, trace_of_steps, of_what_was_there,
                   hessian_of_a_gradient, of_several_types, jacobians_of_several_types):
        yield Case(kernel, (X.copy(), 1.3), ("x", "k"))
    for kernel, refused in (
            (sparse, "S201 at `s2sad.jacobian(residual, \"u\", sparse=True)`: 'sparse' of s2sad.jacobian is not "
             "supported in a kernel: leave it out: the matrix is dense, filled by one product at a time"),
            (several, "S201 at `s2sad.jacobian(residual, (\"u\", \"p\"))(x, p)`: a Jacobian of several outputs, or "
             "with respect to several arguments, is not supported: call it for each: wrt=\"x\", of=\"y\""),
            (unnamed, "S201 at `s2sad.jacobian(residual)(x, p)`: 'residual' takes several arguments: say what the "
             "derivative is with respect to: wrt=\"x\""),
            (of_nothing, "S201 at `s2sad.jacobian(rates, \"u\")(np.zeros(3), x, 1.0)`: the derivative of what 'rates' "
             "returns: it is not one value that it computes: let it return the one float or array that is meant"),
            (of_no_mode, "S201 at `s2sad.jacobian(residual, \"u\", mode=\"sideways\")(x, p)`: there is no mode "
             "'sideways': \"auto\", \"forward\" or \"reverse\""),
            (of_complex_numbers, "S201 at `s2sad.jacobian(total, \"u\")(x * 1j, 1.0)`: a Jacobian of complex numbers: "
             "'return' of 'total', which has two directions: write a function of real and imaginary parts")):
        yield Case(kernel, (X.copy(), P.copy()), refused=refused)
