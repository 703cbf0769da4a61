"""Normal form."""


def limit(a, n):
    taken = a >= n
    if taken:
        result = a - n
        result_4 = result
    else:
        taken_2 = a < 0
        if taken_2:
            result_1 = a + n
            result_3 = result_1
        else:
            result_2 = a
            result_3 = result_2
        result_4 = result_3
    return result_4


def kernel(du, u, p):
    assert len(p) == 2, "unpacked into another number of names than it has items"
    b = p[0]
    alpha = p[1]
    n = u.shape[0]
    for i in range(n):
        for j in range(n):
            ip1 = limit(i + 1, n)
            jm1 = limit(j - 1, n)
            du[i, j, 0] = alpha * (u[ip1, j, 0] - u[i, jm1, 0]) + u[i, j, 0] ** 2 * u[i, j, 1]
            du[i, j, 1] = b * u[i, j, 0] - u[i, j, 0] ** 2 * u[i, j, 1]
