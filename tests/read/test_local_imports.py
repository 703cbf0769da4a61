"""Imports inside a function of a file that is not run."""
from __future__ import annotations

import subprocess
import sys




def test_from_a_file_that_is_not_run(tmp_path):
    (tmp_path / "scales.py").write_text("UNIT = 2.5\n\n\ndef half(v):\n    return 0.5 * v\n")
    path = tmp_path / "model.py"
    path.write_text("def model(x):\n    import numpy as np\n    from scales import UNIT, half\n"
                    "    return half(np.sum(x ** 2)) * UNIT\n")
    made = subprocess.run([sys.executable, "-m", "s2sad", "adjoint", f"{path}:model", "--types", "x: float64[:]"],
                          capture_output=True, text=True, check=False)
    assert "def model_adjoint(x, x_bar, result_bar):" in made.stdout, made.stderr
