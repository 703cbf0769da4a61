"""Loops with an else, jumps out of them, early returns, errors."""

TEXT = '''
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
'''
