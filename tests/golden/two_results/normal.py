"""Normal form."""


def kernel(x, a):
    total = 0.0
    product = a
    total_1 = total
    product_1 = product
    for i in range(x.size):
        total_1 += a * x[i]
        product_2 = product_1 * x[i]
        product_1 = product_2
    return total_1, product_1
