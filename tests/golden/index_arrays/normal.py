"""Normal form."""


def kernel(y, x, source, target):
    for e in range(source.size):
        flow = x[source[e]] * x[target[e]]
        y[source[e]] -= flow
        y[target[e]] += flow
