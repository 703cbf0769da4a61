"""Structures are arrays and numbers under flat names; a number that is assigned is an array of one element."""
from types import SimpleNamespace

import numpy as np


def change(state, p, dt):
    for i in range(state.u.size):
        state.u[i] += dt * p["k"] * state.u[i]


def kernel(state, p, layers, mask=None):
    for w, b in layers:
        change(state, p, b)
        state.t += w[1] * state.u[0]
    if mask is not None:
        state.t *= mask[0]


LAYERS = [(np.array([2.0, 0.3]), 0.1), (np.array([3.0, 0.4]), 0.2)]
ARGUMENTS = (SimpleNamespace(u=np.array([1.0, 2.0]), t=0.5), {"k": 0.7}, LAYERS)
WRT = ("state_u", "state_t", "p_k", "layers_0_0", "layers_1_1")
OF = ("state_u", "state_t")
