"""Loops over time steps of all kinds, with the loops that keep snapshots."""
from __future__ import annotations

import inspect

import numpy as np

import s2sad


def smooth(v, u, c):
    for i in range(1, u.size - 1):
        v[i] = u[i] + c * (u[i - 1] - 2.0 * u[i] + u[i + 1]) * u[i]


def work_array(u, c, n):
    v = np.zeros_like(u)
    total = 0.0
    for k in range(n):
        smooth(v, u, c)
        u += 0.01 * v * (1.0 + k)
        total += np.sum(u * u)
    return total


def strides(u, c, n):
    for k in range(2, n, 3):
        u[k % u.size] = u[k % u.size] * np.sin(c * k) + u[0]
    return np.sum(u ** 2)


def numbers_alone(u, c, n):
    y = 1.0
    for k in range(n):
        u, y = u * np.cos(y * c), y + u * c / (k + 1.0)
    return u * y + c


def rebound(u, c, n):
    for _k in range(n):
        u = u + c * np.roll(u, 1) * u
    return np.sum(u * u)


def swapped(u, c, n):
    v = u * c
    for _k in range(n):
        w = 2.0 * v - u + c * np.sin(v)
        u, v = v, w
    return np.sum(v * v) + np.sum(u)


def left_by_break(u, c, n):
    t = 0.0
    for k in range(n):
        u[1:] = u[1:] + c * u[:-1] * u[1:]
        t = t + c / (k + 1)
        if u[-1] > 1.5:
            break
    return np.sum(u) * t + k


def until_a_time(u, c, n):
    t = 0.0
    while t < n * 0.1:
        dt = 0.1 / (1.0 + u[0] ** 2)
        u[:] = u + dt * c * np.sin(u)
        t += dt
    return np.sum(u * u) + t


def left_by_return(u, c, n):
    for k in range(n):
        u *= 1.0 + c * np.cos(u)
        if u[0] > 2.0:
            return u[0] * k
    return np.sum(u)


def loops_inside(u, c, n):
    for _k in range(n):
        for i in range(3):
            s = 0.0
            for j in range(u.size):
                s += u[j] * u[i]
            u[i] = u[i] + c * s * u[i + 1]
    return np.sum(u * u)


def nested_snapshots(u, c, n):
    for k in range(n):
        for m in range(5):
            u[m] = u[m] * np.exp(-c * u[m + 1]) + 0.01 * k
        u[0] = u[0] * u[1]
    return np.sum(u * u)


def inside_another_loop(u, c, n):
    total = 0.0
    for m in range(3):
        v = u * (1.0 + m * c)
        for _k in range(n):
            v[1:] = v[1:] + c * v[:-1] * v[1:]
        total += np.sum(v) * total + np.sum(v * v)
        u = u * 0.5 + 0.1 * v
    return total + np.sum(u)


def filled_row_by_row(u, c, n):
    out = np.zeros(n + 1)
    for k in range(n):
        u[:] = u + c * np.cos(u)
        out[k] = np.sum(u ** 2)
    return np.sum(out ** 3)


def flags_and_integers(u, c, n):
    flag = True
    m = 0
    for _k in range(n):
        if flag:
            u[:] = u * (1.0 + c)
            m += 2
        else:
            u[:] = u * (1.0 - 0.5 * c) + 0.001 * m
        flag = u[0] < 0.5
    return np.sum(u * u) * m


def helper(u, c, n):
    for k in range(n):
        decay(u, c, k)


def decay(u, c, k):
    for i in range(1, u.size):
        u[i] = u[i] + c * u[i - 1] * u[i] / (k + 1)


def of_a_helper(u, c, n):
    helper(u, c, n)
    s = np.sum(u * u)
    helper(u, c * s, n)
    return np.sum(u * u)


def bounds_that_change(u, c, n):
    m = np.array([n, 2 * n])
    for _k in range(m[0]):
        m[0] = 3
        u[:] = u + c * u * u
    n = 2
    return np.sum(u * u) * n


def bound_counted_down(u, c, n):
    e = 1.0
    for _k in range(n):
        n = n - 1
        e = e * 0.9 + u[0] * c * n
        u[0] = u[0] + e * u[1]
    return e * u[0]


def bound_in_the_loop_alone(u, c, n):
    for k in range(n):
        if k % 2 == 0:
            last = u[0] * c
        u[:] = u + 0.1 * last * u
    return np.sum(u * last)


def part_of_one_element(u, c, n):
    for i in range(min(n, 5)):
        u[:] *= 1.0 + c * u[i:i + 1]
    return np.sum(u)


def row_of_means(u, c, n):
    v = np.outer(u, u)
    for _k in range(n):
        mean = np.mean(v, axis=1, keepdims=True)
        v = v + c * mean * v
    return np.sum(v)


def complex_numbers(u, c, n):
    z = u + 1j * u[::-1]
    for k in range(n):
        z = z * np.exp(1j * c * k) + 0.1 * np.conj(z)
    return np.sum(np.abs(z) ** 2)


def solutions(u, c, n):
    a = np.eye(u.size) + c * np.ones((u.size, u.size))
    for _k in range(n):
        u = np.linalg.solve(a, u) + c * a @ u
        a = a + 0.01 * np.outer(u, u)
    return np.sum(u * u)


def endless(u, c, n):
    k = 0
    while True:
        u[:] = u + c * np.cos(u)
        k += 1
        if k > n:
            break
    return np.sum(u) * k


def linear(u, c, n):
    a = np.eye(u.size) + c * np.ones((u.size, u.size))
    for k in range(n):
        u[:] = a @ u / (k + 2.0)
    return np.sum(u)


def linear_until(u, c, n):
    t = 0.0
    while t < n * 0.1:
        u[1:] = 0.5 * u[1:] + 0.25 * u[:-1]
        t += 0.1
    return np.sum(u) * c


def linear_left(u, c, n):
    for k in range(n):
        u *= 0.5
        if k > 4:
            break
    return np.sum(u) * c


@s2sad.nondifferentiable
def cosine_times(a, b):
    return np.cos(a) * b


@s2sad.rule(a="cosine_times(a, b)", b="np.sin(a)")
def sine_times(a, b):
    return np.sin(a) * b


def by_rules(u, c, n):
    for k in range(n):
        by_a_rule(u, c, k)
        u[0] = sine_times(u[0], cosine_times(0.1 * k, 1.0))
    return np.sum(u * u)


def by_a_rule(u, c, k):
    u[k % u.size] = sine_times(u[k % u.size], c) + 0.5 * u[0]


def _while_of(kernel) -> str:
    """What a user calls the `while` of a kernel."""
    lines, first = inspect.getsourcelines(kernel)
    return f"line {first + next(k for k, line in enumerate(lines) if line.strip().startswith('while'))}"


LOOPS = {
    work_array: ("k",), strides: ("k",), numbers_alone: ("k",), rebound: ("_k",), swapped: ("_k",),
    left_by_break: ("k",), left_by_return: ("k",), loops_inside: ("_k",), nested_snapshots: ("k", "m"),
    inside_another_loop: ("_k",), filled_row_by_row: ("k",), flags_and_integers: ("_k",), of_a_helper: ("helper.k",),
    bounds_that_change: ("_k",), bound_counted_down: ("_k",), bound_in_the_loop_alone: ("k",),
    until_a_time: (_while_of(until_a_time),), part_of_one_element: ("i",), row_of_means: ("_k",),
    complex_numbers: ("k",), solutions: ("_k",), endless: (_while_of(endless),),
    linear: ("k",), linear_until: (_while_of(linear_until),), linear_left: ("k",),
    by_rules: ("k",),
}

# those that read what no step binds
OF_A_STEP = (left_by_break, bound_in_the_loop_alone)
