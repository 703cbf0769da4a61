"""Normal form."""


def kernel(x, limit):
    total = 1.0
    returned = False
    result = 0.0
    result_1 = result
    returned_1 = returned
    total_1 = total
    for i in range(x.size):
        taken = x[i] < 0.0
        if taken:
            result_2 = total_1 * x[i]
            returned_2 = True
            result_1 = result_2
            returned_1 = returned_2
            break
        else:
            total_2 = total_1 * x[i]
            taken_2 = total_2 > limit
            if taken_2:
                total_1 = total_2
                break
            else:
                total_1 = total_2
    taken_3 = not returned_1
    if taken_3:
        result_3 = total_1 * total_1
        result_4 = result_3
    else:
        result_4 = result_1
    return result_4
