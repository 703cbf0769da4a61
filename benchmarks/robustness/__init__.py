"""Where derivatives break: zeros and choices, published failures, conditions, long and chaotic runs.

    cases       what a case is: a kernel, where it is differentiated, and its gradient worked out by hand
    zeros       the law of zeros and choices, conventions at kinks, saturated functions
    published   failures that other tools have had, as their users reported them
    conditions  errors against condition numbers, and of long sums
    runs        gradients over long, stiff and chaotic runs
    document    the second half of `docs/accuracy.md`
"""
