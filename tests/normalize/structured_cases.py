"""Small hostile functions: order of evaluation, laziness, jumps, loops. Each is run as written and in its form."""
from __future__ import annotations

HELPERS = '''
def push(x, v):
    x[0] = x[0] * 2.0 + v
    return x[0]
def both(x, v):
    x[1] += v
    return x[1], v - x[0]
def pure(a, b=2.0, c=-1.0):
    return a * b - c
def log(x, v):
    x[2] = x[2] * 10.0 + v
    return v
def reset(x):
    x[:] = 1.0
'''

# Each takes x (four floats, changed in place), n (an integer) and v (a float).
CASES = {name.strip(): body for name, body in (case.split(":", 1) for case in '''
and_lazy: if v > 0.0 and push(x, v) > 1.0: x[1] = 5.0
===
and_lazy_else:
    if v > 0.0 and push(x, v) > 1.0:
        x[1] = 5.0
    else:
        x[1] = 6.0
===
or_lazy: if v > 0.0 or push(x, v) > 1.0: x[1] = 5.0
===
or_value: return v or log(x, 2.0) or push(x, 1.0)
===
and_value:
    y = v and log(x, 1.0) and log(x, 2.0)
    return y
===
and_reads_target:
    y = v
    y = y and push(x, y)
    return y
===
mixed_lazy:
    if (log(x, 1.0) > v or log(x, 2.0) > v) and not (log(x, 3.0) < v and log(x, 4.0) < v):
        return log(x, 5.0)
    return log(x, 6.0)
===
chain_calls: return log(x, 1.0) < log(x, v) < log(x, 3.0) < log(x, 4.0)
===
chain_middle_once:
    if x[0] < x[1] + v < push(x, v):
        return 1.0
    return x[0]
===
chain_left_held: return x[0] + 1.0 < x[0] * v < push(x, 3.0)
===
choice_nested: return log(x, 1.0) if v > 0.0 else log(x, 2.0) if v > -1.0 else log(x, 3.0)
===
choice_in_test: return 1.0 if (push(x, v) if v > 0.0 else x[1]) > 1.0 else x[0]
===
choice_in_sum: return x[0] + (push(x, v) if v > 0.0 else x[1]) * x[0]
===
choice_lazy_index: return x[n] if n < 4 else 0.0
===
choice_store: x[n % 4] = x[0] if v > 0.0 else x[1]
===
choice_augment: x[n % 4] += x[0] if v > 0.0 else -x[1]
===
choice_unpack:
    a, b = (x[0], x[1]) if v > 0.0 else (x[1], x[0])
    return a - 2.0 * b
===
order_held: return x[0] + push(x, v) + x[0]
===
order_twice: return push(x, 1.0) - push(x, 2.0) * x[0]
===
order_arguments: return pure(x[0], push(x, v), x[0])
===
order_keywords: return pure(c=log(x, 1.0), a=log(x, 2.0))
===
defaults: return pure(v) + pure(v, c=3.0) + pure(v, 1.0, 4.0)
===
order_store: x[int(log(x, 1.0))] = push(x, v)
===
order_augment: x[0] += push(x, v)
===
order_augment_index: x[int(log(x, 1.0))] *= push(x, v) + x[0]
===
order_augment_name:
    s = v
    s += push(x, s)
    s -= x[0]
    return s
===
order_numpy: return np.maximum(x[0], push(x, v)) + max(x[1], push(x, 1.0))
===
order_nested: return push(x, push(x, v) + x[0]) + x[0]
===
order_view:
    y = x[:]
    return y[1] + log(x, v) + y[1]
===
order_sum: return np.sum(x) + push(x, v)
===
order_name_array:
    y = x + push(x, v)
    return y[0] + y[1]
===
order_binary_array:
    y = x * 2.0 + push(x, v)
    return y[0] + y[1]
===
order_index_array:
    k = np.array([0, 1, 2])
    x[k[1]] = v + log(x, 1.0)
===
swap:
    a, b = v, x[0]
    a, b = b, a
    return a - 3.0 * b
===
rotate:
    a, b, c = v, 1.0, 2.0
    a, b, c = b, c, a
    return a + 10.0 * b + 100.0 * c
===
swap_elements: x[0], x[1] = x[1], x[0]
===
swap_mixed:
    k = 1
    k, x[k] = 2, 7.0
    x[k], k = float(k), 3
    return k
===
swap_calls:
    a, b = 1.0, 2.0
    a, b = push(x, b), push(x, a)
    return a - b
===
swap_element_call: x[0], x[1] = v, push(x, 3.0)
===
fibonacci:
    a, b = 0.0, 1.0
    for _ in range(n):
        a, b = b, a + b
    return a
===
unpack_own_name:
    p = x
    p, q, r, s = p
    return p + q - r * s
===
unpack_nested:
    (a, b), (c, d) = (x[0], v), (x[1], x[2])
    return a - b * c + d
===
unpack_array:
    a, b, c, d = x * 2.0
    return a - b + c * d
===
unpack_shape:
    m, = x.shape
    return m
===
chained:
    a = b = x[0] = v + 1.0
    return a + b
===
chained_element_first:
    x[0] = b = v + x[1]
    return b
===
chained_index:
    k = x[n % 4] = 1
    return k
===
chained_tuple:
    p = a, b = v, 2.0
    return p[0] + a * b
===
chained_two_tuples:
    a, b = c, d = push(x, v), x[0]
    return a + b * c - d
===
chained_calls:
    a = b = push(x, v)
    return a + b
===
annotated:
    a: float = v
    b: float
    b = a + 1.0
    return b
===
several_results:
    a, b = both(x, v)
    x[0], c = both(x, a)
    return a + b - c
===
several_indexed: return both(x, v)[1] + both(x, 1.0)[-2]
===
several_named:
    r = both(x, v)
    s, t = r
    if v > 0.0:
        r = both(x, s)
    return r[0] + r[1] * t
===
several_returned:
    if v > 0.0:
        return both(x, v)
    return x[0], v
===
several_named_returned:
    r = (x[0], x[1])
    if v > 0.0:
        r = (r[1], r[0])
    return r
===
expression_statement:
    """Not a docstring: text."""
    v + x[0] * push(x, v)
    reset(x) if v > 0.0 else push(x, 1.0)
    "text"
    pass
===
fill:
    x.fill(v)
    np.multiply(x, 2.0, out=x)
===
while_call:
    k = 0
    while push(x, v) < 50.0 and k < n:
        k += 1
        if k == 2:
            continue
        x[1] += k
    return k
===
while_call_else:
    k = 0
    while log(x, k) < n:
        k += 1
        if k > 3:
            break
    else:
        return 100.0 + k
    return k
===
while_else_outer_jump:
    s = 0.0
    for i in range(n):
        k = 0
        while log(x, k) < i:
            k += 1
            if k == 2:
                break
        else:
            if i == 2:
                continue
            if i == 4:
                break
        s += 10.0 * i + k
    return s
===
for_else:
    for i in range(n):
        if i * v > 2.0:
            break
    else:
        x[0] = -1.0
    x[1] = i if n > 0 else 0.0
===
for_else_return:
    for i in range(n):
        if i * v > 2.0:
            return i
    else:
        return -1.0
===
else_without_break:
    for i in range(n):
        x[0] += i
    else:
        x[1] = 5.0
===
deep_continue:
    s = 0.0
    for i in range(n):
        if i % 2 == 0:
            if v > i:
                continue
            s += 1.0
        else:
            s += 0.5
        s *= 2.0
        x[0] += s
    return s
===
deep_break:
    s = 0.0
    for i in range(n):
        if i % 2 == 0:
            if v < i:
                break
            s += 1.0
        elif i == 3:
            s -= 2.0
        s *= 2.0
    else:
        s += 1000.0
    return s
===
deep_all:
    s = 0.0
    for i in range(n):
        if i % 2 == 0:
            if v < i:
                break
            elif v > i + 2:
                return s
            s += 1.0
        else:
            if i == 3:
                continue
        s += i
    return -s
===
return_in_nested_loops:
    for i in range(n):
        for j in range(n):
            while True:
                x[0] += 1.0
                if x[0] > 3.0 * v + 4.0:
                    return i * 10.0 + j
                if x[0] % 2.0 < 1.0:
                    break
            x[1] += j
        x[2] += i
    return -1.0
===
return_only_exit:
    k = 0
    while True:
        k += 1
        for i in range(k):
            if i + k > n:
                return i * v
        if k > 20:
            return -1.0
===
return_after_partial:
    if v > 0.0:
        if n > 2:
            return 1.0
        x[0] = 3.0
    else:
        x[0] = 4.0
    x[1] = x[0]
    return x[1] + 1.0
===
return_flag_sequence:
    for i in range(n):
        if i > v:
            return 1.0
    for i in range(n):
        if i > v + 1.0:
            return 2.0
        x[0] += i
    if v > 100.0:
        for i in range(n):
            return 3.0
    return 4.0
===
return_same_name:
    total = 0.0
    for i in range(n):
        total += x[i % 4]
        if total > v:
            return total
    return total
===
return_none_early:
    for i in range(n):
        if x[i % 4] > v:
            return
        x[i % 4] = v
    x[3] = 9.0
===
return_pairs:
    for i in range(n):
        if i * v > 1.5:
            return i, x[0]
    return -1, push(x, v)
===
return_integer:
    for i in range(n):
        if i > v:
            return i
    return n
===
return_boolean:
    for i in range(n):
        if x[i % 4] > v:
            return True
    return n > 100
===
raises:
    if v > 1.0:
        raise ValueError("too large")
    elif n == 3:
        return 1.0
    assert n != 4, "four"
    return x[n]
===
raise_ends:
    if v > 0.0:
        return push(x, v)
    raise ValueError("negative")
===
assert_message_lazy: assert v > 0.0, log(x, 5.0)
===
variable_after:
    i = 77
    for i in range(n):
        x[i % 4] += i
    return i
===
variable_changed:
    s = 0
    for i in range(n):
        i *= 2
        s += i
        for i in range(2):
            s += i
        s += 10 * i
    return s
===
variable_nested_same:
    s = 0
    for i in range(n):
        for i in range(i):
            s += i
    return s
===
variable_parameter:
    for n in range(n):
        x[0] += n
    return n
===
variable_in_while:
    k = 0
    i = 5
    while k < 3:
        x[0] += i
        for i in range(k):
            x[1] += i
        k += 1
===
variable_break_value:
    for i in range(10):
        for j in range(10):
            if i * j > n:
                break
        else:
            continue
        break
    return i * 100 + j
===
bound_changed:
    m = n
    for i in range(m):
        m += 1
        x[0] += m
    return m
===
bound_stored:
    k = np.array([1, 3, 2])
    for i in range(k[0], k[1]):
        k[1] += 1
        k[0] = 9
        x[0] += i
    return k[1]
===
bound_called:
    for i in range(int(log(x, 2.0)), int(push(x, 3.0)) % 5):
        push(x, i)
===
over_array:
    s = 0.0
    for row in x:
        s += row * v
        x[1] = 100.0
    return s
===
over_array_rebound:
    y = x
    for row in y:
        y = row * 2.0
    return y
===
over_expression:
    s = 0.0
    for a in x[:] * 2.0:
        if a > v:
            continue
        s += a
    return s
===
over_rows:
    m = np.ones((3, 2))
    for row in m:
        row[0] = v
        row += 1.0
    return np.sum(m)
===
enumerate_plain:
    s = 0.0
    for i, a in enumerate(x):
        s += i * a
        if s > v:
            break
    return s
===
enumerate_start:
    s = 0.0
    for i, a in enumerate(x, 3):
        s += i * a
    return s + i
===
enumerate_keyword:
    s = 0.0
    for i, a in enumerate(x[...], start=n):
        n = 3
        s += i * a
    return s
===
zip_lengths:
    s = 0.0
    for a, b, i in zip(x, x[:], range(n)):
        s += a * b - i
    return s
===
zip_same: return both(x, v)[0] + 0.0
===
zip_rebinds:
    a, b = x, x[:]
    for a, b in zip(a, b):
        x[3] += a - 2.0 * b
    return a
===
enumerate_zip:
    s = 0.0
    for k, (a, b) in enumerate(zip(x, range(2, n))):
        s += k * a + b
    return s
===
zip_ranges:
    s = 0
    for a, b, c in zip(range(3, n), range(n, -5, -2), range(1, 20, 3)):
        s += a * 100 + b * 10 + c
    return s
===
reversed_range:
    s = 0
    for i in reversed(range(n)):
        s = s * 10 + i
    for i in reversed(range(2, n)):
        s = s * 10 + i
    for i in reversed(range(1, n, 3)):
        s = s * 10 + i
    for i in reversed(range(n, 0, -2)):
        s = s * 10 + i
    for i in reversed(range(n, 0, -1)):
        s = s * 10 + i
    return s
===
reversed_array:
    s = 0.0
    for a in reversed(x):
        s = s * 2.0 + a
    for i, a in enumerate(reversed(x)):
        s += i * a
    return s
===
indices_plain:
    m = np.zeros((2, 3))
    for i, j in np.ndindex(2, 3):
        m[i, j] = i + v * j
    for i, j in np.ndindex(m.shape):
        m[i, j] += 1.0
    for i, j in np.ndindex((2, 3)):
        m[i, j] -= v
    return np.sum(m)
===
indices_break:
    s = 0
    for i, j in np.ndindex(n, 3):
        if j == 1:
            continue
        if i * 3 + j > 4:
            break
        s += 1
    else:
        s += 100
    return s * 100 + i * 10 + j if n > 0 else s
===
indices_return:
    for i, j, k in np.ndindex(n, 2, 2):
        if i + j + k > 2:
            return i * 100 + j * 10 + k
        x[j] += k
    return -1
===
indices_named:
    m = np.zeros((2, 3))
    for at in np.ndindex(2, 3):
        m[at] = at[0] + v
        if at[1] == 2:
            continue
        m[at] += at[-1]
    return np.sum(m)
===
written_out:
    s = 0.0
    for q in (1.0, 2.0, v):
        if q > 1.5:
            continue
        s += q
    return s + q
===
written_out_break:
    s = 0.0
    for q, w in [(1.0, x[0]), (2.0, x[1]), (v, x[2])]:
        x[1] = 50.0
        s += q * w
        if s > 2.0:
            break
    else:
        s = -s
    return s
===
written_out_arrays:
    y = x * 2.0
    for a, b in ((x, y), (y, x)):
        for i in range(4):
            a[i] += b[3 - i]
    return y[0]
===
written_out_named:
    offsets = (-1, 0, 2)
    s = 0
    for i, o in enumerate(offsets):
        s += i * x[o]
    for o in offsets:
        s += x[o]
    return s
===
own_result:
    result = v
    returned = 1.0
    for i in range(n):
        result += returned
        if result > 3.0:
            return result * 2.0
    return returned
===
empty_loops:
    for i in range(n):
        pass
    for j in range(n):
        continue
    return v
===
dead_code:
    for i in range(n):
        break
        x[0] = 100.0
    return v
    x[1] = 7.0
===
boolean_not:
    s = 0.0
    for i in range(n):
        if not (x[i % 4] < v):
            continue
        s += 1.0
        if i != 2:
            continue
        s += 10.0
    return s
===
nan_branches:
    w = v * np.nan
    for i in range(n):
        if w < i:
            continue
        x[0] += 1.0
'''.split("\n===\n"))}


def text_of(name: str) -> str:
    body = CASES[name]
    body = "    " + body.strip() + "\n" if not body.startswith("\n") else body
    return HELPERS + f"\ndef case(x, n, v):\n{body}\n"
