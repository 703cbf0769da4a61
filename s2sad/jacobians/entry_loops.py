"""Loops over the entries of a pattern, in a text that Numba compiles; `entry_arrays` has the same for the interpreter.

A pattern is held as its lists, one after the other: `members[starts[k]:starts[k + 1]]` are the rows of column k, or the
columns of row k.
"""
import numpy as np


def turned(starts, members, count):
    """The lists by member: those of the rows from those of the columns."""
    found = np.zeros(count + 1, np.int64)
    for k in range(members.size):
        found[members[k] + 1] += 1
    for k in range(count):
        found[k + 1] += found[k]
    free = found[:-1].copy()
    lists = np.empty(members.size, np.int64)
    for k in range(starts.size - 1):
        for m in range(starts[k], starts[k + 1]):
            lists[free[members[m]]] = k
            free[members[m]] += 1
    return found, lists


def first_fit(starts, members, room, order):
    """A colour for each column, taken in this order: the first that no column has with which it shares a row. Row i has
    `room[i + 1] - room[i]` columns."""
    columns = starts.size - 1
    colors = np.zeros(columns, np.int64)
    taken = np.empty(members.size, np.int64)    # the colours of each row's columns
    filled = room[:-1].copy()
    near = np.full(columns + 1, -1)
    for column in order:
        for k in range(starts[column], starts[column + 1]):
            for t in range(room[members[k]], filled[members[k]]):
                near[taken[t]] = column
        color = 0
        while near[color] == column:
            color += 1
        for k in range(starts[column], starts[column + 1]):
            taken[filled[members[k]]] = color
            filled[members[k]] += 1
        colors[column] = color
    return colors


def parted(starts, members, lanes, parts, told):
    """The lists in parts, of which list k has `parts[k]`: in part p of it are those of its members where `told` has
    True at `lanes[k] + p`."""
    found = np.zeros(parts.sum() + 1, np.int64)
    part = 0
    for k in range(parts.size):
        for p in range(parts[k]):
            count = 0
            for m in range(starts[k], starts[k + 1]):
                count += told[members[m], lanes[k] + p]
            found[part + 1] = found[part] + count
            part += 1
    lists, free = np.empty(found[-1], np.int64), 0
    for k in range(parts.size):
        for p in range(parts[k]):
            for m in range(starts[k], starts[k + 1]):
                if told[members[m], lanes[k] + p]:
                    lists[free] = members[m]
                    free += 1
    return found, lists


def agrees(entries, weights, told, theirs, precision, least):
    """Whether entries times weights, summed to the places that are told, are what somebody else has there, where they
    are finite: within `precision` of the terms, or `least` of the greatest ones anywhere."""
    ours, scale = np.zeros(theirs.size), np.zeros(theirs.size)
    for k in range(entries.size):
        term = entries[k] * weights[k]
        ours[told[k]] += term
        scale[told[k]] += abs(term)
    greatest = 0.0
    for i in range(theirs.size):
        scale[i] += abs(theirs[i]) if np.isfinite(theirs[i]) else 0.0
        greatest = max(greatest, scale[i]) if np.isfinite(scale[i]) else greatest
    for i in range(theirs.size):
        if np.isfinite(ours[i]) and not abs(theirs[i] - ours[i]) <= precision * scale[i] + least * greatest:
            return False
    return True
