"""The rules of functions that move elements about: the shadow's elements move back."""
from __future__ import annotations

from s2sad.rules.array import arrays

arrays("numpy.roll(x, shift, axis=None)", law="along", x="numpy.roll(g, -shift, axis=axis)")
arrays("numpy.flip(x, axis=None)", law="along", x="numpy.flip(g, axis=axis)")
arrays("numpy.transpose(x)", law="transposed", x="numpy.transpose(g)")
arrays("numpy.moveaxis(x, source, destination)", law="moved", x="numpy.moveaxis(g, destination, source)")
arrays("numpy.reshape(x, shape)", law="reshaped", x="numpy.reshape(g, x.shape)")
arrays("numpy.ravel(x)", law="raveled", x="numpy.reshape(g, x.shape)")
