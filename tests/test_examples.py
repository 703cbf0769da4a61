"""The examples run as a user runs them, and say what is missing where something is."""
from __future__ import annotations

import subprocess
import sys

import pytest

from tests.harness.documents import ROOT, environment

EXAMPLE, GLACIER, CHANNEL = (ROOT / "examples" / f"{name}.py" for name in ("brusselator", "glacier", "channel"))


def run(*arguments, cwd=None, code=None, example=EXAMPLE):
    command = [sys.executable, *(["-c", code] if code else [str(example)]), *arguments]
    return subprocess.run(command, cwd=cwd, env=environment(), capture_output=True, text=True, encoding="utf-8",
                          check=False)


def test_brusselator_recovers_its_parameters(tmp_path):
    for module in ("numba", "scipy", "rich", "matplotlib"):
        pytest.importorskip(module)
    done = run("--quick", "--output", "fields.png", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert '"""Adjoint of misfit: d(return) / d(amplitude, p).' in done.stdout
    assert "def misfit_adjoint(amplitude, p, p_bar, observed, dt, steps, result_bar):" in done.stdout
    rows = [line.split("│") for line in done.stdout.splitlines() if line.startswith("│") and line.count("│") == 6]
    errors = {row[1].strip(): float(row[5].strip(" %")) for row in rows}
    assert set(errors) == {"A", "B", "alpha", "amplitude"}
    assert max(errors.values()) < 5.0
    assert float(done.stdout.split("differences agree to ")[1].split()[0].rstrip(".")) < 1e-6
    picture = (tmp_path / "fields.png").read_bytes()
    assert picture.startswith(b"\x89PNG") and len(picture) > 20_000


@pytest.mark.parametrize(("given", "said"), [
    (["--n", "2"], "--n is at least 4, --steps at least 8"),
    (["--n", "256"], "with --n 256 explicit Euler needs at least --steps 12583"),
    (["--quick", "--output", "nowhere/fields.png"], "--output: there is no folder"),
    (["--steps", "many"], "invalid int value: 'many'")])
def test_brusselator_refuses(given, said, tmp_path):
    done = run(*given, cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr


def test_brusselator_names_the_missing_extras(tmp_path):
    code = f"""
import runpy, sys
import importlib.util as util
found = util.find_spec
util.find_spec = lambda name, *rest: None if name in ("rich", "matplotlib") else found(name, *rest)
sys.argv = ["brusselator.py", "--quick"]
runpy.run_path({str(EXAMPLE)!r}, run_name="__main__")
"""
    done = run(cwd=tmp_path, code=code)
    assert done.returncode == 1
    assert done.stderr == 'this example needs rich, matplotlib: pip install "s2sad[progress,plot]"\n'


def test_glacier_finds_its_bed_and_the_softness_of_its_ice(tmp_path):
    for module in ("numba", "scipy", "rich", "matplotlib"):
        pytest.importorskip(module)
    done = run("--quick", "--output", "glacier.png", cwd=tmp_path, example=GLACIER)
    assert done.returncode == 0, done.stderr
    text = " ".join(done.stdout.split())
    assert float(text.split(" m rms")[0].split()[-1]) < 1.0
    assert float(text.split("differences agree to ")[1].split()[0].rstrip(".")) < 1e-6
    assert float(text.split("rate factor is within ")[1].split("%")[0]) < 5.0
    picture = (tmp_path / "glacier.png").read_bytes()
    assert picture.startswith(b"\x89PNG") and len(picture) > 20_000


def test_channel_recovers_its_wave_and_its_roughness(tmp_path):
    for module in ("scipy", "rich", "matplotlib"):
        pytest.importorskip(module)
    done = run("--quick", "--output", "channel.png", cwd=tmp_path, example=CHANNEL)
    assert done.returncode == 0, done.stderr
    rows = [line.split("│") for line in done.stdout.splitlines() if line.startswith("│") and line.count("│") == 5]
    errors = {row[1].strip(): float(row[4].split()[0].strip("%")) for row in rows}
    assert errors["height of the wave, m"] < 0.02
    assert errors["roughness"] < 10.0
    assert float(done.stdout.split("differences agree to ")[1].split()[0].rstrip(".")) < 1e-3
    assert (tmp_path / "channel.png").read_bytes().startswith(b"\x89PNG")
