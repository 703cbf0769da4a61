"""Subscripts that pick elements on both sides of a slice: NumPy puts the axes of what they pick first."""
import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

PLACES, OTHERS = np.array([2, 0, 1]), np.array([1, 1, 3])
HIGH = np.array([True, False, True, True, False])


def number_and_places(a, places):
    total = 0.0
    for i in range(a.shape[0]):
        picked = a[i, :, places]
        total += np.sum(picked[0] * picked[-1]) + picked[1, 0]
    return total


def number_and_mask(a, high):
    picked = a[-1, 1:3, high]
    return np.sum(picked ** 2) + picked[1, 0] * len(picked)


def places_on_both_sides(a, places, others):
    return np.sum(a[places, ..., others] * a[places, None, :, others][:, 0] * a[1, ::-1, places])


def places_of_two_axes(a, places, others):
    return np.sum(np.sin(a[places[:, None], :2, others]) * a[places, :2, 0])


def places_of_a_part(a, places):
    return np.sum(a[0][:, places] * a[1][1:, places][0] + a[-1][..., places])


def stores(a, places, high):
    a = a.copy()
    a[0, :, places] = a[1, :, places] * a[0, :, places]
    a[2, 1:, high] = a[0, 0, 0]
    a[:, -1, places] *= a[1, 2, 3]
    a[1, :, [1]] -= 0.5 * a[1, :, [2]]
    return np.sum(a ** 2)


def places_picked_twice(a, others):
    a = a.copy()
    a[0, :, others] = a[1, :, :3].T * 2.0
    a[1, :, others] += 1.0
    a[2, :, others] *= a[1, :, others]
    return np.sum(a ** 3)


def in_a_loop_that_writes(a, places):
    a = a.copy()
    total = 0.0
    for i in range(2):
        a[i, :, places] *= a[i + 1, 0, 0]
        total += np.sum(a[i, :, places] ** 2)
        a[i + 1] += 0.1 * np.sum(a[i, :, places])
        places[0] = i
    return total + np.sum(a ** 2)


def cases():
    a = generator(7).normal(size=(3, 4, 5))
    for kernel, given in ((number_and_places, (PLACES,)), (number_and_mask, (HIGH,)),
                          (places_on_both_sides, (PLACES, OTHERS)), (places_of_two_axes, (PLACES, OTHERS)),
                          (places_of_a_part, (PLACES,)), (stores, (PLACES, HIGH)), (places_picked_twice, (OTHERS,)),
                          (in_a_loop_that_writes, (PLACES,))):
        yield Case(kernel, (a, *given), ("a",))
