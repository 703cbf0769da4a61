"""Tests of PyTorch are collected where it is installed; the extra `test` leaves it out, for it takes gigabytes."""
from __future__ import annotations

from importlib.util import find_spec

collect_ignore = [] if find_spec("torch") else ["test_torch.py"]
