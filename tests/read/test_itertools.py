"""A kernel in a file that names itertools in a way of its own."""
from __future__ import annotations





def test_read_from_text(tmp_path):
    path = tmp_path / "kernel.py"
    path.write_text("import itertools as it\nimport numpy as np\n\n\ndef kernel(a):\n    s = 0.0\n"
                    "    for i, j in it.product(range(2), range(3)):\n        s += a[i, j]\n    return s\n")
    from s2sad.cli import main
    assert main(["adjoint", f"{path}:kernel"]) in (0, None)
