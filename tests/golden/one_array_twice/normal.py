"""Normal form."""


def add(out, a, b):
    for i in range(out.size):
        out[i] = a[i] * b[i]


def add_2(out, b):
    for i in range(out.size):
        out_here = out[i]
        out[i] = out_here * b[i]


def kernel(u, v):
    add(v, u, u)
    add_2(u, v)
