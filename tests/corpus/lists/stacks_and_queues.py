"""Lists that are stacks and queues of a loop whose trips only the run counts, and lists that are made anew in it."""
from __future__ import annotations

import bisect
import heapq
from collections import deque

import numpy as np

from tests.corpus import Case

X = np.array([0.7, 0.4, 0.9, 0.3, 1.1, 0.5])


def depth_first(x, n):
    stack, s = [0], 0.0
    while stack:
        i = stack.pop()
        s += x[i] ** 2 / (1.0 + s)
        if 2 * i + 1 < n:
            stack.append(2 * i + 1)
        if 2 * i + 2 < n:
            stack.append(2 * i + 2)
    return s


def breadth_first(x, n):
    queue, s, w = deque([0]), 0.0, 1.0
    seen = np.zeros(n, bool)
    seen[0] = True
    while queue:
        i = queue.popleft()
        s += w * x[i] ** 2
        w *= 0.9
        for j in (i - 1, i + 2):
            if 0 <= j < n and not seen[j]:
                seen[j] = True
                queue.append(j)
    return s


def of_numbers(x):
    stack, s = [x[0]], 0.0
    while stack:
        v = stack.pop()
        if v < 0.1:
            s += v * v
        else:
            stack.append(v * 0.5)
            stack.append(v * x[1])
    return s


def of_pairs(x):
    todo, s = [(x[0], x[1])], 0.0
    while todo:
        pair = todo.pop()
        if pair[1] - pair[0] < 0.2:
            s += pair[0] * pair[1]
        else:
            todo.append((pair[0], 0.6 * pair[1]))
            todo.append((pair[0] * 1.2, pair[1] * 0.9))
    return s


def adaptive_quadrature(x):
    def f(t):
        return np.exp(-x[0] * t * t)
    todo, total = [(0.0, x[1] + 1.0)], 0.0
    while todo:
        a, b = todo.pop()
        m = 0.5 * (a + b)
        one = (b - a) * (f(a) + f(b)) / 2
        two = (b - a) * (f(a) + 2 * f(m) + f(b)) / 4
        if abs(one - two) < 1e-3:
            total += two
        else:
            todo.append((a, m))
            todo.append((m, b))
    return total


def of_arrays(x):
    stack, s = [x.copy()], 0.0
    while stack:
        v = stack.pop()
        if np.sum(v) < 1.0:
            s += np.sum(v ** 2)
        else:
            stack.append(v * 0.5)
            stack.append(v * 0.3 + 0.01 * v ** 2)
    return s


def of_operands(x):
    stack, s, t = [], 0.0, 0.0
    while t < 2.0:
        stack.append(x[0] * t)
        stack.append(x[1] + t)
        a = stack.pop()
        b = stack.pop()
        stack.append(a * b)
        s += stack[-1] + len(stack)
        t += 0.4 * x[2]
    return s - stack.pop() * x[3] * stack.pop()


def moving_average(x):
    window, s, t, total = [], 0.0, 0.0, 0.0
    while t < 2.0:
        v = np.sin(t) * x[0]
        window.append(v)
        total += v
        if len(window) > 4:
            total -= window.pop(0)
        window[0] += 0.01 * total
        s += total / len(window) * max(window) + sum(window[1:]) + window[-1] * window[len(window) - 2]
        for a, b in zip(window[:-1], window[1:]):
            s += a * b
        t += 0.17 * x[2]
    return s + np.sum(np.array(window) ** 2)


def taken_back(x):
    """What is taken out of the list is written, while others go where it was."""
    u, t, saved = x.copy(), 0.0, []
    for _ in range(12):
        saved.append((t, u.copy()))
        u *= 1.1 + 0.1 * x[0]
        t += 0.1
        if np.sum(u) > 7.0:
            t, u = saved.pop()
            u[1:] *= 0.6
    return t * np.sum(u) + sum(time * np.sum(v ** 2) for time, v in saved)


def taken_out_beside_its_name(x):
    us, s, t = [], 0.0, 0.0
    for _ in range(6):
        t += x[0]
        w = x * t
        us.append(w)
        if t > 2.0:
            v = us.pop()
            v[0] = 2.0
            us.append(0.3 * v)
            t -= 1.6
        s += w[0] ** 2
    return s + sum(np.sum(u ** 3) for u in us)


def cleared(x):
    q, s, t = [], 0.0, 0.0
    while t < 1.0:
        q.append(x[0] * t)
        t += 0.11 * x[2]
        if len(q) == 3:
            s += q[0] * q[2]
            q.clear()
    return s + len(q)


def neighbours(x, cut):
    found = []
    for i in range(len(x)):
        for j in range(i + 1, len(x)):
            if abs(x[i] - x[j]) < cut:
                found.append((i, j))
    return found


def made_anew_by_a_function(x, n):
    u, v = x.copy(), np.zeros_like(x)
    pairs = neighbours(u, 0.45)
    for step in range(n):
        if step % 3 == 0:
            pairs = neighbours(u, 0.45)
        f = np.zeros_like(u)
        for i, j in pairs:
            f[i] += u[i] - u[j]
            f[j] -= u[i] - u[j]
        v += 0.1 * f
        u += 0.1 * v
    return np.sum(u ** 2)


class System:
    def __init__(self, u):
        self.u = u.copy()
        self.build()

    def build(self):
        self.pairs = neighbours(self.u, 0.45)

    def energy(self):
        return sum((self.u[i] - self.u[j]) ** 2 for i, j in self.pairs)


def made_anew_by_a_method(x, n):
    system, s = System(x), 0.0
    for step in range(n):
        if step % 2 == 0:
            system.build()
        s += system.energy()
        system.u *= 0.9
    return s


def generations(x):
    old, t, s = [x[0]], 0.0, 0.0
    while t < 1.0:
        new = []
        for p in old:
            new.append(p * 1.1)
            if p * t < 0.2:
                new.append(p * x[1])
        s += sum(new) * len(old)
        old = new
        t += 0.3 * x[2]
    return s


def kept_where_it_is_longer(x):
    best, s, t = [x[1]], 0.0, 0.0
    while t < 2.0:
        t += 0.3 * x[2]
        new = []
        while True:
            new.append(t * x[0] * len(new) + x[1])
            if sum(new) > 1.5:
                break
        if len(new) > len(best):
            best = new
        s += best[-1]
    return s + sum(best)


def left_by_continue(x):
    out, s, t, k = [x[0]], 0.0, 0.0, 0
    while t < 2.0:
        t += 0.3 * x[2]
        k += 1
        new = []
        new.append(t * x[1])
        if k % 2 == 0:
            continue
        new.append(x[3] * t)
        out = new
        s += sum(out)
    return s + sum(out) * len(out)


def first_of_what_was_there(x):
    v, s, t = x.copy(), 0.0, 0.0
    rows = [v * 2]
    while t < 1.0:
        first = rows[0]
        rows = [v * t, v * t * t]
        rows.append(v ** 2)
        s += np.sum(first * rows[-1])
        t += 0.2 * x[0] + 0.1
        v = v * 0.9
    return s


def two_names(x):
    a, t, s = [x[0]], 0.0, 0.0
    while t < 1.0:
        b = a
        b.append(a[-1] * x[1] + t)
        a.append(b[-1] * 0.5)
        s += len(b) * b[0] * a[-1]
        t += 0.3 * x[2]
    return s + sum(a)


def exchanged(x):
    a, b, t = [x[0]], [x[1], x[2]], 0.0
    while t < 1.0:
        a, b = b, a
        a.append(b[-1] * 0.7 + t)
        t += 0.3 * x[2]
    return a[-1] * b[-1]


def put_in_front(x):
    q, t = [x[0]], 0.0
    while t < 1.0:
        q.insert(0, x[1] * t)
        t += 0.3 * x[2]
    return q[0] * q[-1]


def from_within(x):
    q, t = [x[0], x[1], x[2]], 0.0
    while t < 1.0:
        q.append(t * q.pop(1))
        q.append(t)
        t += 0.3 * x[2]
    return q[0] * q[-1]


def of_places_and_weights(x, n):
    stack, s = [(0, 1.0)], 0.0
    while len(stack) > 0:
        k, w = stack.pop()
        s += w * x[k] ** 2
        for c in (2 * k + 1, 2 * k + 2):
            if c < n:
                stack.append((c, w * x[k]))
    return s


def of_numbers_and_arrays(x):
    t, v, log, k = 0.0, x.copy(), [], 0
    while t < 1.0:
        v = v * 0.9
        k += 1
        if v[0] > 0.3:
            log.append((k, (t, v.copy()), np.sum(v ** 2)))
        t += 0.1 * x[2]
    s = 0.0
    for k, (t, w), e in log:
        s += e * t + w[1] * x[k % 3]
    return s + log[-1][2] * log[0][1][1][1] + len(log)


def rows_that_move(x):
    q, t, k = [], 0.0, 0
    while t < 1.0:
        q.append((k, np.sin(3 * t) * x[1] + len(q)))
        k += 1
        t += 0.2 * x[2]
    q[0], q[1] = q[1], q[0]
    q[2] = (q[0][0] + 1, q[2][1] * q[-1][1])
    best = q[0]
    for row in q:
        if row[1] > best[1]:
            best = row
    return best[1] * x[best[0]] + q[1][1] * q[2][1] * x[q[0][0]]


def made_of_itself(x, n):
    q, k = [x[0]], 0
    while k < n:
        if len(q) > 2:
            q = [q[-1], q[0]]
        q.append(x[2] * k)
        k += 1
    return q[0] + 2 * q[1]


def made_of_its_sums(x, n):
    q, k = [x[0]], 0
    while k < n:
        if len(q) > 2:
            q = [x[3], sum(q), max(q)]
        q.append(x[2] * k)
        k += 1
    return q[0] + 2 * q[1] + 3 * q[-1]


def made_of_its_rows(x, n):
    q, k = [x * 1.0], 0
    while k < n:
        if len(q) > 2:
            first = q[0]
            q = [q[-1], first]
        q.append(x[2] * k * x)
        k += 1
    return np.sum(q[0] + 2 * q[1])


def made_of_its_pairs(x, n):
    q, k = [(x[0], x[1])], 0
    while k < n:
        if len(q) > 2:
            q = [(q[-1][1], q[0][0]), (q[0][1], q[-1][0])]
        q.append((x[2] * k, x[3]))
        k += 1
    return q[0][0] + 2 * q[1][1] + 3 * q[0][1]


def shifted(x, n):
    h, s = [x[0], x[1]], 0.0
    for k in range(n):
        h = [h[1], h[0] * 0.5 + h[1]]
        h.append(x[k])
        s += h[0] * 2 + h[1] + h[2]
    return s


def made_of_the_one_before(x):
    old, t, s = [x[0], x[1]], 0.0, 0.0
    while t < 2:
        new = [old[-1] * 0.9, old[0]]
        s += new[0] * new[-1]
        new.append(t * x[3])
        old = new
        t += 0.3 * x[2]
    return s


def swapped(q):
    return [q[1], q[0]]


def made_by_a_function_of_itself(x, n):
    q, s, k = [x[0], x[1]], 0.0, 0
    while k < n:
        if k % 3 == 2:
            q = [q[0], q[-1] * 0.7]
        else:
            q = swapped(q)
        q.append(x[k])
        s += q[0] * 2 + q[1]
        k += 1
        if k > 40:
            break
    else:
        s += q[-1]
    return s


def read_from_the_second_round_on(x):
    history, s = [], 0.0
    for i in range(len(x)):
        if i > 1:
            s += history[-1] * x[i]
        history.append(x[i] ** 2)
    return s


def of_a_length(x):
    first, last, s = [], deque(), 0.0
    for v in x:
        if len(first) == 3:
            s += first.pop(0) * v
            s += last.popleft()
        first.append(v ** 2)
        last.append(v ** 3)
    return s + last[0] * sum(first)


def last_one_changed(x):
    found = []
    for i in range(len(x)):
        if i > 0 and x[i] < 0.6:
            found[-1] = found[-1] * x[i]
        else:
            found.append(x[i] ** 2)
    return sum(found) * found[-1]


def beyond_the_end(x):
    q = [x[0] ** 2]
    return q[2] if x[1] > 0.7 else q[0]


def changed_within(x):
    us, t = [], 0.0
    while t < 1.0:
        us.insert(0, x[0] * t)
        t += 0.3 * x[0]
        us.insert(2, x[1] * t)
        us.insert(-1, x[2] * t ** 2)
    s = sum((k + 1) * u ** 2 for k, u in enumerate(us))
    us.reverse()
    us.pop(1)
    del us[2]
    return s + sum((k + 1) * u for k, u in enumerate(us))


def the_worst_one(x):
    us = [v * v for v in x if v > 0.35]
    worst = max(us)
    us.remove(worst)
    return sum(us) + worst * us[0]


def at_both_ends(x):
    q, s, t = deque(), 0.0, 0.0
    while t < 1.0:
        q.appendleft(x[0] * t)
        q.append(x[1] + t)
        t += 0.25 * x[2]
        if len(q) > 4:
            s += q.pop() * q.popleft()
    q.rotate(1)
    q.rotate(-3)
    return s + sum((k + 1) * u ** 2 for k, u in enumerate(q))


def the_best_three(x):
    beam = [(0.0, 0)]
    for k in range(4):
        new = []
        for s, n in beam:
            new.append((s + x[k], n + 1))
            new.append((s - 0.3 * x[k] ** 2, n))
        new.sort(reverse=True)
        beam = new[:3]
    return beam[0][0] + 0.1 * beam[1][0] * beam[1][1]


def shortest_paths(x):
    far = np.array([[0, 1, 4, 0, 0, 0], [1, 0, 2, 5, 0, 0], [4, 2, 0, 1, 3, 0], [0, 5, 1, 0, 1, 2], [0, 0, 3, 1, 0, 4],
                    [0, 0, 0, 2, 4, 0]]) * 1.0
    least = np.full(6, np.inf)
    least[0] = 0.0
    queue = [(0.0, 0)]
    while queue:
        d, u = heapq.heappop(queue)
        if d > least[u]:
            continue
        for v in range(6):
            if far[u, v] > 0.0 and d + far[u, v] * x[u] + 0.1 * x[v] ** 2 < least[v]:
                least[v] = d + far[u, v] * x[u] + 0.1 * x[v] ** 2
                heapq.heappush(queue, (least[v], v))
    return np.sum(least * np.arange(6))


def as_a_heap_lies(x):
    h = [v * 1.5 for v in x if v > 0.35]
    heapq.heapify(h)
    heapq.heappush(h, x[0] * 0.3)
    s = heapq.heapreplace(h, 0.2 * x[1])
    return s + sum((j + 2) * v for j, v in enumerate(h))


def put_in_order(x):
    us = []
    for v in x:
        if v > 0.35:
            bisect.insort(us, v * v)
    return us[0] * 3 + us[-1] + bisect.bisect(us, 0.3) * x[0]


def limited_memory(x):
    """BFGS with the last three steps."""
    weights = np.array([1.0, 3.0, 0.5, 2.0, 1.0, 0.7])
    z, steps, changes = np.zeros(6), [], []
    g = 2 * (z - x) * weights
    for _ in range(6):
        q, factors = g.copy(), []
        for s, y in zip(reversed(steps), reversed(changes)):
            factors.append((s @ q) / (y @ s))
            q = q - factors[-1] * y
        q = q * (steps[-1] @ changes[-1]) / (changes[-1] @ changes[-1]) if steps else 0.2 * q
        for s, y, a in zip(steps, changes, reversed(factors)):
            q = q + s * (a - (y @ q) / (y @ s))
        new = z - 0.7 * q
        steps.append(new - z)
        changes.append(2 * (new - x) * weights + 0.4 * new ** 3 - g)
        if len(steps) > 3:
            steps.pop(0)
            changes.pop(0)
        z, g = new, 2 * (new - x) * weights + 0.4 * new ** 3
        if g @ g < 1e-9:
            break
    return np.sum((z - 2 * x) ** 2)


def the_last_ones(x):
    us, t, s = [], 0.0, 0.0
    while t < 2.0:
        us.append(np.sin(t) * x[0])
        t += 0.3 + 0.1 * x[1] ** 2
        s += max(us[-3:]) - min(us[-2:]) + np.mean(us[-4:]) + sum(us[-2:])
        if len(us) > 3 and np.mean(us[-3:]) > 0.9:
            break
    return us[0] + us[-1] + s


KERNELS = [shortest_paths, as_a_heap_lies, put_in_order, limited_memory, the_last_ones,
           read_from_the_second_round_on, of_a_length, last_one_changed, beyond_the_end,
           of_numbers, of_pairs, adaptive_quadrature, of_arrays, of_operands, moving_average, cleared, generations,
           kept_where_it_is_longer, left_by_continue, first_of_what_was_there, two_names, of_numbers_and_arrays,
           rows_that_move, made_of_the_one_before, taken_back, taken_out_beside_its_name, put_in_front, from_within,
           changed_within, the_worst_one, at_both_ends, the_best_three]
COUNTED = [(depth_first, 6), (breadth_first, 6), (of_places_and_weights, 6),
           (made_of_itself, 7), (made_of_its_sums, 7), (made_of_its_rows, 7), (made_of_its_pairs, 7),
           (shifted, 6), (made_by_a_function_of_itself, 6),
           (made_anew_by_a_function, 7), (made_anew_by_a_method, 5)]


def cases():
    # gradients
    for kernel in KERNELS:
        yield Case(kernel, (X,), ("x",))
    for kernel, n in COUNTED:
        yield Case(kernel, (X, n), ("x",))
    # refusals
    yield Case(exchanged, (X,), refused=(
        "S201 at `a.append(b[-1] * 0.7 + t)`: append to 'b', which is not bound once, to a list: bind it once, as [] "
        "or as a list of what it starts with"))
