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


def star_fit(starts, members, twins, order):
    """A colour for each vertex of a graph, taken in this order, so that neighbours differ and no path of four vertices
    has two colours: edges of two colours are stars. `members` are the neighbours of each, `twins` where the same edge
    stands among those of the other end. Gebremedhin, Tarafdar, Manne and Pothen, New acyclic and star coloring
    algorithms, SIAM J. Sci. Comput. 29, 2007, algorithm 4.1."""
    vertices = len(starts) - 1
    colors, treated = np.full(vertices, -1), np.full(vertices, -1)
    near, seen, first = np.full(vertices + 1, -1), np.full(vertices + 1, -1), np.full(vertices + 1, -1)
    star, hub, stars = np.full(len(members), -1), np.full(len(members), -1), 0
    for v in order:
        for e in range(starts[v], starts[v + 1]):
            w = members[e]
            if w == v or colors[w] < 0:
                continue
            c = colors[w]
            near[c] = v
            if seen[c] == v:        # two neighbours of one colour: none of theirs may have the colour of v
                for root in (members[first[c]], w):
                    if treated[root] != v:
                        treated[root] = v
                        for g in range(starts[root], starts[root + 1]):
                            if members[g] != root and colors[members[g]] >= 0:
                                near[colors[members[g]]] = v
                continue
            seen[c], first[c] = v, e
            for g in range(starts[w], starts[w + 1]):
                x = members[g]
                if x != v and x != w and colors[x] >= 0 and hub[star[min(g, twins[g])]] == x:
                    near[colors[x]] = v
        color = 0
        while near[color] == v:
            color += 1
        colors[v] = color
        for e in range(starts[v], starts[v + 1]):
            w, edge, joined = members[e], min(e, twins[e]), -1
            if w == v or colors[w] < 0:
                continue
            for g in range(starts[w], starts[w + 1]):
                if members[g] != v and colors[members[g]] == color:
                    joined = star[min(g, twins[g])]
                    hub[joined] = w
                    break
            if joined < 0 and first[colors[w]] != e:
                joined = star[min(first[colors[w]], twins[first[colors[w]]])]
                hub[joined] = v
            if joined < 0:
                joined = stars
                stars += 1
            star[edge] = joined
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
