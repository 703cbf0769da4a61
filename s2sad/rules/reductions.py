"""The rules of functions that reduce an array along axes."""
from __future__ import annotations

from s2sad.rules.array import arrays

_SPREAD = "runtime.spread(g, x.shape, axis, keepdims)"
_FIRST = "runtime.extreme_mask(x, y, axis, keepdims)"

arrays("numpy.sum(x, axis=None, keepdims=False)", law="summed", x=_SPREAD)
arrays("numpy.mean(x, axis=None, keepdims=False)", law="averaged", x=f"{_SPREAD} * (numpy.size(y) / x.size)")
# at a tie the first element is the one that is followed
for _name in ("max", "min"):
    arrays(f"numpy.{_name}(x, axis=None, keepdims=False)", law="reduced", also=(f"numpy.a{_name}",),
           x=f"numpy.where({_FIRST} != 0, {_SPREAD}, 0.0)",
           tangent=f"numpy.sum(numpy.where({_FIRST} != 0, x_dot, 0.0), axis=axis, keepdims=keepdims)")

# places, not values: no derivative
arrays("numpy.argsort(x, axis=-1, kind=None)", law="places")
arrays("runtime.places(x, shape, part)", law="counted")
arrays("runtime.sought(a, v, right)", law="sought")
arrays("runtime.spread(x, shape, axis=None, keepdims=False)", law="spread")
arrays("numpy.broadcast_to(x, shape)", law="spread")
arrays("runtime.scattered(x, shape, places)", law="spread")
arrays("runtime.extreme_mask(x, y, axis=None, keepdims=False)", law="same")
