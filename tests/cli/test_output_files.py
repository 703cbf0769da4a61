"""Where the output goes: files that are written, and those that are not written over."""
from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests.cli.files import SCALE


def test_a_file_is_written_whole(ran, kernel, tmp_path):
    kernel(SCALE)
    assert ran("tangent", "k.py:scale", "-o", "out.py")[:2] == (0, "")
    assert "def scale_tangent(u, u_dot, c, c_dot):" in (tmp_path / "out.py").read_text()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["k.py", "out.py"]


def test_a_refusal_leaves_the_file_as_it_was(ran, kernel, tmp_path):
    kernel("def f(a):\n    total = 0.0\n    with a:\n        total += 1.0\n    return total\n")
    (tmp_path / "out.py").write_text("kept")
    status, out, err = ran("adjoint", "k.py:f", "-o", "out.py")
    assert (status, out) == (1, "") and "k.py:3:" in err
    assert (tmp_path / "out.py").read_text() == "kept"


def test_what_was_read_is_not_written_over(ran, kernel, tmp_path):
    kernel("from helpers import double\nfrom constants import G\n\n\ndef f(x):\n    return double(x) * G\n")
    kernel("def double(x):\n    return 2.0 * x\n", "helpers.py")
    kernel("G = 9.81\n", "constants.py")
    os.link("k.py", "hard.py")
    os.symlink("helpers.py", "soft.py")
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    for output, same in (("k.py", ""), ("hard.py", f", which is {tmp_path / 'k.py'}"), ("constants.py", ""),
                         ("soft.py", f", which is {tmp_path / 'helpers.py'}")):
        for command in ("adjoint", "explain", "stages", "check"):
            assert ran(command, "k.py:f", "-o", output) == (
                1, "", f"error[S407]: {output}: the function is read from this file{same}\n"
                "  help: give -o another file\n")
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="POSIX files")
def test_only_plain_files_are_written_over(ran, kernel, tmp_path):
    kernel(SCALE)
    os.mkfifo("pipe")
    (tmp_path / "there.py").write_text("old\n")
    (tmp_path / "there.py").chmod(0o640)
    os.symlink("there.py", "link.py")
    for output, what in (("pipe", "no plain file"), (os.devnull, "no plain file"), (".", "a directory")):
        assert ran("adjoint", "k.py:scale", "-o", output) == (
            1, "", f"error[S407]: {output}: cannot be written (it is {what})\n"
            "  help: give -o a file, or leave it out to print\n")
    assert ran("adjoint", "k.py:scale", "-o", "link.py")[0] == 0
    assert (tmp_path / "link.py").is_symlink() and "def scale_adjoint" in (tmp_path / "there.py").read_text()
    assert (tmp_path / "there.py").stat().st_mode & 0o777 == 0o640
    assert ran("adjoint", "k.py:scale", "-o", "-")[1] == (tmp_path / "there.py").read_text()


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="Linux's device")
def test_letters_that_the_terminal_lacks_and_a_full_disk(tmp_path):
    (tmp_path / "k.py").write_bytes("# coding: latin-1\ndef f(x):\n    ä = x * x\n    return ä\n".encode("latin-1"))
    done = subprocess.run([sys.executable, "-m", "s2sad", "adjoint", "k.py:f"], capture_output=True, cwd=tmp_path,
                          env={**os.environ, "PYTHONIOENCODING": "ascii"}, check=True)
    assert "ä_bar = result_bar" in done.stdout.decode()
    with open("/dev/full", "w") as full:
        done = subprocess.run([sys.executable, "-m", "s2sad", "adjoint", "k.py:f"], stdout=full, text=True,
                              stderr=subprocess.PIPE, cwd=tmp_path, check=False)
    assert (done.returncode, done.stderr) == (
        1, "error[S407]: standard output cannot be written (No space left on device)\n  help: give -o a file\n")


def test_an_output_that_cannot_be_written(ran, kernel):
    kernel(SCALE)
    assert ran("adjoint", "k.py:scale", "-o", "nowhere/out.py") == (
        1, "", "error[S407]: nowhere/out.py: cannot be written (No such file or directory)\n"
        "  help: give -o a file in a folder that is there and can be written to\n")
