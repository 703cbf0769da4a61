"""What is evaluated, and in which order."""

TEXT = '''
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
'''
