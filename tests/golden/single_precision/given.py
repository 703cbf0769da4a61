"""A float32 kernel: its shadows are float32."""
import math

import numpy as np


def kernel(y, x):
    for i in range(x.size):
        half = np.float32(0.5) * x[i]
        y[i] = half * math.exp(half)


ARGUMENTS = (np.zeros(3, np.float32), np.array([0.7, -1.3, 0.4], np.float32))
WRT, OF = ("x",), ("y",)
