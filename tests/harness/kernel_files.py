"""Kernels that a test writes to a file of its own, from which they are read as a user's are."""
from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any


def kernel_file(path: Path, head: str, lines: Iterable[str], result: str) -> Callable[..., Any]:
    """The function of a file that is written: its `def` line, the lines of its body, and what it returns."""
    name = head[:head.index("(")]
    body = "".join(f"    {line}\n" for line in (*lines, f"return {result}"))
    path.write_text(f"import numpy as np\n\n\ndef {head}:\n{body}")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return getattr(module, name)
