"""What loops go through, and what their variables are inside and behind."""

TEXT = '''
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
'''
