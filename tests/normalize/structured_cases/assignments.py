"""Targets of every kind, and results of several values."""

TEXT = '''
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
'''
