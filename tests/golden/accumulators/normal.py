"""Normal form."""


def kernel(y, x):
    total = 0.0
    product = 1.0
    total_1 = total
    product_1 = product
    for i in range(x.size):
        total_1 += x[i] * x[i]
        y[0] -= 2.0 * x[i]
        product_2 = product_1 * x[i]
        product_1 = product_2
    y[1] = total_1 * product_1
