"""Functions whose derivative is zero wherever it exists, with the kind of what they return.

"same" is the type of the arguments: `numpy.floor` of a float32 is a float32. Each of them jumps somewhere;
there the derivative is taken as 0 as well.
"""
from __future__ import annotations

from s2sad.rules.rule import constant

# stair functions: flat between their jumps
constant("same", "numpy.floor", "numpy.ceil", "numpy.rint", "numpy.trunc", "numpy.fix", "numpy.round",
         "numpy.around", "numpy.round_", "numpy.sign", "a // b", "numpy.floor_divide")
constant("int", "math.floor", "math.ceil", "math.trunc", "builtins.round", "builtins.int", "numpy.int_",
         "numpy.int8", "numpy.int16", "numpy.int32", "numpy.int64", "numpy.intp", "numpy.uint8", "numpy.uint16",
         "numpy.uint32", "numpy.uint64")

# positions, counts and integer arithmetic
constant("int", "builtins.len", "numpy.argmax", "numpy.argmin", "numpy.argsort", "numpy.searchsorted",
         "numpy.count_nonzero", "numpy.size", "numpy.ndim", "numpy.bitwise_and", "numpy.bitwise_or",
         "numpy.bitwise_xor", "numpy.bitwise_not", "numpy.invert", "numpy.left_shift", "numpy.right_shift",
         "math.gcd", "math.lcm", "math.comb", "math.perm", "math.factorial", "math.isqrt",
         "runtime.lcm", "runtime.comb", "runtime.perm", "runtime.factorial", "runtime.isqrt",
         "runtime.whole_power", "runtime.whole_product", "runtime.position", "runtime.position_down", "runtime.element")

# questions
constant("bool", "builtins.bool", "numpy.bool_", "numpy.bool", "numpy.isnan", "numpy.isinf", "numpy.isfinite",
         "numpy.isclose", "numpy.allclose", "numpy.array_equal", "numpy.signbit", "numpy.any", "numpy.all",
         "numpy.greater", "numpy.greater_equal", "numpy.less", "numpy.less_equal", "numpy.equal", "numpy.not_equal",
         "numpy.logical_and", "numpy.logical_or", "numpy.logical_not", "numpy.logical_xor", "math.isnan",
         "math.isinf", "math.isfinite", "math.isclose", "runtime.isclose")
