"""Normal form."""


def kernel(u, p):
    assert len(p) == 3, "unpacked into another number of names than it has items"
    a = p[0]
    b = p[1]
    c = p[2]
    for i in range(u.size):
        u_here = u[i]
        ratio = b / c
        u[i] = a * u_here * u_here + ratio
