"""The tool for GradBench, asked as an eval asks it, and derivatives with which its answers are compared."""
from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.gradbench import function, protocol

RUNS = {"min_runs": 1, "min_seconds": 0}


def asked(module: str, name: str, given: Any) -> Any:
    """The output for an input that went through JSON, as an eval's does. Nothing is compiled: what is checked does not
    depend on the engine."""
    function.ENGINE = "numpy"
    message = {"id": 7, "kind": "evaluate", "module": module, "function": name,
               "input": given | RUNS if isinstance(given, dict) else given}
    answer = json.loads(json.dumps(protocol.Tool().answer(json.dumps(message)), allow_nan=False))
    assert answer["success"], answer["error"]
    assert answer["id"] == 7
    assert [t["name"] for t in answer["timings"]] == ["prepare", "evaluate"]
    assert all(isinstance(t["nanoseconds"], int) and t["nanoseconds"] >= 0 for t in answer["timings"])
    return answer["output"]


def differences(f: Callable[[np.ndarray], Any], x: np.ndarray, step: float = 1e-3) -> np.ndarray:
    """Derivatives of f for each element of x, by central differences extrapolated to order 4."""
    def slope(k: int, h: float) -> np.ndarray:
        moved = h * np.eye(x.size)[k].reshape(x.shape)
        return (np.asarray(f(x + moved)) - np.asarray(f(x - moved))) / (2.0 * h)
    return np.array([(4.0 * slope(k, 0.5 * step) - slope(k, step)) / 3.0 for k in range(x.size)])
