"""The command, run here, on a file in a folder of the test."""
from __future__ import annotations

import pytest

from s2sad.cli import main


@pytest.fixture
def ran(capsys):
    """Runs the command; gives (status, stdout, stderr)."""
    def run(*arguments):
        try:
            status = main([str(a) for a in arguments])
        except SystemExit as end:
            status = end.code
        return (status, *capsys.readouterr())
    return run


@pytest.fixture
def kernel(tmp_path, monkeypatch):
    """Writes a file `k.py` into the working directory."""
    monkeypatch.chdir(tmp_path)

    def write(text, name="k.py"):
        (tmp_path / name).write_text(text, encoding="utf-8")
    return write
