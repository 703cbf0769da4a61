"""lists: what lists of Python's do of which only the run knows how long they are.

    us.insert(0, v)         ->      held = us[:];  us.clear();  us.append(v);  for u in held: us.append(u)
    sorted(us, key=f)       ->      order = np.argsort(np.array([f(u) for u in us]), kind="stable")
                                    [us[k] for k in order]

`METHODS` has their methods, `QUEUES` what `heapq` does.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np


# -- methods ---------------------------------------------------------------------------------------------------------
def extend(items, iterable):
    held = iterable[:]
    for k in range(len(held)):
        items.append(held[k])


def insert(items, index, object):
    held = items[:]
    place = max(index + len(held), 0) if index < 0 else min(index, len(held))
    items.clear()
    for k in range(place):
        items.append(held[k])
    items.append(object)
    for k in range(place, len(held)):
        items.append(held[k])


def appendleft(items, x):
    held = items[:]
    items.clear()
    items.append(x)
    for k in range(len(held)):
        items.append(held[k])


def pop(items, index):
    held = items[:]
    place = index + len(held) if index < 0 else index
    if place < 0 or place >= len(held):
        raise IndexError("pop index out of range")
    items.clear()
    for k in range(len(held)):
        if k != place:
            items.append(held[k])
    return held[place]


def remove(items, value):
    held = items[:]
    found = False
    items.clear()
    for k in range(len(held)):
        if not found and held[k] == value:
            found = True
        else:
            items.append(held[k])
    if not found:
        raise ValueError("list.remove(x): x not in list")


def reverse(items):
    held = items[:]
    items.clear()
    for k in range(len(held)):
        items.append(held[len(held) - 1 - k])


def rotate(items, n=1):
    held = items[:]
    items.clear()
    for k in range(len(held)):
        items.append(held[(k - n) % len(held)])


def sort(items, *, key=None, reverse=False):
    held = sorted(items, key=key, reverse=reverse)
    items.clear()
    for k in range(len(held)):
        items.append(held[k])


def index(items, value):
    for k, item in enumerate(items):
        if item == value:
            return k
    raise ValueError("the value is not in the list")


def count(items, value):
    found = 0
    for item in items:
        if item == value:
            found += 1
    return found


METHODS: dict[str, Callable[..., Any]] = {
    f.__name__: f for f in (
        insert, appendleft, pop, remove, reverse, rotate, sort, index, count)}


# -- bisect and heapq ------------------------------------------------------------------------------------------------
def insort_right(a, x, *, key=None):
    low, high = 0, len(a)
    wanted = x if key is None else key(x)
    while low < high:
        middle = (low + high) // 2
        if wanted < (a[middle] if key is None else key(a[middle])):
            high = middle
        else:
            low = middle + 1
    a.insert(low, x)


def insort_left(a, x, *, key=None):
    low, high = 0, len(a)
    wanted = x if key is None else key(x)
    while low < high:
        middle = (low + high) // 2
        if (a[middle] if key is None else key(a[middle])) < wanted:
            low = middle + 1
        else:
            high = middle
    a.insert(low, x)


def heappush(heap, item):
    heap.append(item)
    towards_root(heap, 0, len(heap) - 1)


def heappop(heap):
    last = heap.pop()
    least = last
    if len(heap) > 0:
        least = heap[0]
        heap[0] = last
        towards_leaves(heap, 0)
    return least


def heapify(x):
    for k in range(len(x) // 2 - 1, -1, -1):
        towards_leaves(x, k)


def heapreplace(heap, item):
    least = heap[0]
    heap[0] = item
    towards_leaves(heap, 0)
    return least


def towards_root(heap, start, place):
    """An item of a heap goes to where none above it is larger."""
    item = heap[place]
    while place > start and item < heap[(place - 1) // 2]:
        heap[place] = heap[(place - 1) // 2]
        place = (place - 1) // 2
    heap[place] = item


def towards_leaves(heap, start):
    """The smaller one of those below goes up until there is none, and from there the item does, as in CPython."""
    place, end, item = start, len(heap), heap[start]
    below = 2 * start + 1
    while below < end:
        if below + 1 < end and not heap[below] < heap[below + 1]:
            below = below + 1
        heap[place] = heap[below]
        place = below
        below = 2 * place + 1
    heap[place] = item
    towards_root(heap, start, place)


QUEUES: dict[str, Callable[..., Any]] = {f.__name__: f for f in (heappush, heappop, heapify, heapreplace)}


# -- orders ----------------------------------------------------------------------------------------------------------
def keys_of(items, key):
    return [key(item) for item in items]


def numbers_of(keys):
    numbers = np.array(keys)
    if numbers.ndim != 1:
        raise ValueError("arrays are ordered: give a key that is a number")
    return numbers


def order_of_numbers(keys, back):
    """The places of numbers in their order; of equal ones the first is the first."""
    numbers = numbers_of(keys)
    return np.argsort(0 - numbers if back else numbers, kind="stable")


def order_of_columns(columns, back):
    """The places of rows of numbers, by the first column first."""
    order = np.arange(len(columns[0]))
    for numbers in columns[::-1]:
        held = numbers[order]
        order = order[np.argsort(0 - held if back else held, kind="stable")]
    return order


def order_of_rows(keys, back, width):
    return order_of_columns([numbers_of([row[k] for row in keys]) for k in range(width)], back)


def first_of_numbers(keys, back):
    numbers = numbers_of(keys)
    return np.argmax(numbers) if back else np.argmin(numbers)


def first_of_rows(keys, back, width):
    return order_of_rows(keys, back, width)[0]


def in_order(items, order):
    return [items[k] for k in order]
