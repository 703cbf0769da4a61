"""How exact values and derivatives are: errors in units in the last place, against references of 113 bits.

    reference     the derivative that s2sad writes, run on quadruple precision
    text          the text of a function so that each of its numbers has 113 bits
    quad          numbers of 113 bits
    modules       what stands there for `numpy`, `math` and `scipy`
    linalg        what stands there for `numpy.linalg`
    complexes     complex arrays, and what stands there for `numpy.fft`

    rules         elementwise rules, against truths: functions and partials by mpmath
    nonfinite     the same rules where an argument is infinite or nan
    arrays        functions of whole arrays and their options
    kernels       the benchmarks' kernels
    expressions   those of fpbench
    sums          sums that derivatives make

    document      the tables of `docs/accuracy.md`
    literals      partials of 25 digits for `tests/rules/test_ulp.py`
"""
