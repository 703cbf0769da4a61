"""What `entry_loops` computes, without a compiler: see there."""
from __future__ import annotations

import numpy as np

from s2sad.jacobians import entry_loops


def turned(starts: np.ndarray, members: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The lists by member.

    >>> turned(np.array([0, 2, 3]), np.array([0, 1, 1]), 2)
    (array([0, 1, 3]), array([0, 0, 1]))
    """
    found = np.concatenate([[0], np.cumsum(np.bincount(members, minlength=count))])
    keys = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    return found, keys[np.argsort(members, kind="stable")]


def first_fit(starts: np.ndarray, members: np.ndarray, room: np.ndarray, order: np.ndarray) -> np.ndarray:
    """A colour for each column: the first that no column has with which it shares a row.

    >>> first_fit(np.array([0, 1, 3, 4]), np.array([0, 0, 1, 1]), np.array([0, 2, 4]), np.arange(3))
    array([0, 1, 0])
    """
    taken = [0] * (len(room) - 1)       # the colours of a row's columns, as bits
    colors = np.zeros(len(starts) - 1, int)
    bounds, rows = starts.tolist(), members.tolist()
    for column in order.tolist():
        near, mine = 0, rows[bounds[column]:bounds[column + 1]]
        for row in mine:
            near |= taken[row]
        free = ~near & (near + 1)
        for row in mine:
            taken[row] |= free
        colors[column] = free.bit_length() - 1
    return colors


def star_fit(starts: np.ndarray, members: np.ndarray, twins: np.ndarray, order: np.ndarray) -> np.ndarray:
    """A colour for each vertex, so that edges of two colours are stars.

    >>> star_fit(np.array([0, 1, 3, 5, 6]), np.array([1, 0, 2, 1, 3, 2]), np.array([1, 0, 3, 2, 5, 4]), np.arange(4))
    array([0, 1, 0, 2])
    """
    return entry_loops.star_fit(starts.tolist(), members.tolist(), twins.tolist(), order.tolist())


def parted(starts: np.ndarray, members: np.ndarray, lanes: np.ndarray, parts: np.ndarray, told: np.ndarray
           ) -> tuple[np.ndarray, np.ndarray]:
    """The lists in parts."""
    owner, first = np.repeat(np.arange(len(parts)), np.diff(starts)), np.cumsum(parts) - parts
    keys, found = [np.zeros(0, int)], [np.zeros(0, int)]
    for p in range(int(parts.max(initial=0))):
        hit = np.flatnonzero(told[members, np.minimum(lanes[owner] + p, told.shape[1] - 1)] & (p < parts[owner]))
        keys.append(first[owner[hit]] + p)
        found.append(members[hit])
    every = np.concatenate(keys)
    bounds = np.concatenate([[0], np.cumsum(np.bincount(every, minlength=int(parts.sum())))])
    return bounds, np.concatenate(found)[np.argsort(every, kind="stable")]


def agrees(entries: np.ndarray, weights: np.ndarray, told: np.ndarray, theirs: np.ndarray, precision: float,
           least: float) -> bool:
    """Whether entries times weights, summed to the places that are told, are what somebody else has there."""
    with np.errstate(all="ignore"):     # what is not finite in the matrix is seen there
        terms = entries * weights
        ours = np.bincount(told, terms, len(theirs))
        scale = np.bincount(told, np.abs(terms), len(theirs)) + np.where(np.isfinite(theirs), np.abs(theirs), 0.0)
        bound = precision * scale + least * scale.max(initial=0.0, where=np.isfinite(scale))
        return bool(np.all((np.abs(theirs - ours) <= bound) | ~np.isfinite(ours)))
