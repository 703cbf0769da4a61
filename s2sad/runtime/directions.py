"""Memory for the numbers of many directions."""
from __future__ import annotations

import numpy as np


def lanes(width, dtype=np.float64):
    """Room for one number of each direction; for compiled code on the stack (`run/lanes.py`)."""
    return np.empty(width, dtype)
