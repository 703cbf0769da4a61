"""Texts: files that cannot be read, that change on disk, and functions that have no source."""
from __future__ import annotations

import linecache
import math
import os
import subprocess
import sys

import numpy as np
import pytest

import s2sad
from s2sad import read
from tests.read.test_linker import imported
from tests.read.test_supported_subset import printed, refusal, write


def test_missing_directory_encoding(tmp_path):
    gone = tmp_path / "gone.py"
    assert refusal(read.load_file, gone, "f") == (
        f"error[S101]: {gone}: no such file\n  help: check the path, which is relative to the working directory")
    assert refusal(read.load_file, tmp_path, "f") == (
        f"error[S101]: {tmp_path}: this is a directory\n  help: give a Python file: kernel.py:function")
    latin = tmp_path / "latin.py"
    latin.write_bytes(b"def f(x):\n    return x\n\n# caf\xe9\n")
    assert refusal(read.load_file, latin, "f") == (
        f"{latin}:4:6: error[S101]: not UTF-8 (byte 0xe9)\n  4 | # caf\ufffd\n    |      ^\n"
        "  help: save the file as UTF-8, or name its encoding in the first line: # -*- coding: latin-1 -*-")
    latin.write_bytes(b"# caf\xe9\n")
    assert refusal(read.load_file, latin, "f") == (
        f"{latin}:1:6: error[S101]: not UTF-8 (byte 0xe9)\n  1 | # caf\ufffd\n    |      ^\n  help: save the file as "
        "UTF-8, or name its encoding in the first line: # -*- coding: latin-1 -*-")
    for first, column in ((b"# coding: klingon", 11), (b"\xef\xbb\xbf# coding: latin-1", 12), (b"# coding: hex", 11)):
        latin.write_bytes(first + b"\ndef f(x):\n    return x\n")
        assert refusal(read.load_file, latin, "f") == printed(
            latin, 1, first.decode(), first.decode()[column - 1:], "S101",
            "an encoding that Python does not read files in", "save the file as UTF-8")
    latin.write_bytes(b"\xef\xbb\xbfdef f(x):\n    return x  # caf\xc3\xa9\n")
    assert read.load_file(latin, "f").entry == "f"
    latin.write_bytes(b"# -*- coding: latin-1 -*-\r\ndef f(x):\r\n    \xe4 = x\r\n    return \xe4\r\n")
    assert read.load_file(latin, "f").entry == "f"
    latin.write_bytes(b"# -*- coding: latin-1 -*-\n# caf\xe9\ndef f(x):\n    return x\n")
    assert read.load_file(latin, "f").entry == "f"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="POSIX files")
def test_pipes_and_devices_are_not_read(tmp_path):
    os.mkfifo(tmp_path / "pipe.py")
    for path in (tmp_path / "pipe.py", "/dev/zero"):
        assert refusal(read.load_file, path, "f") == (
            f"error[S101]: {path}: this is no file, but a pipe or a device\n"
            "  help: write the text to a file: kernel.py:function")
    (tmp_path / "k.py").write_text("from pipe import g\ndef f(x):\n    return g(x)\n")
    assert "error[S201]" in refusal(read.load_file, tmp_path / "k.py", "f")


def test_not_python(tmp_path):
    path = write(tmp_path, "def f(x):\n    return x +* 2\n")
    assert refusal(read.load_file, path, "f") == printed(
        path, 2, "    return x +* 2", "*", "S102", "not Python: invalid syntax",
        "correct the line; the file must be one that Python itself can read")
    path = write(tmp_path, "return 1\n")
    assert refusal(read.load_file, path, "f") == printed(
        path, 1, "return 1", "return 1", "S102", "not Python: 'return' outside function",
        "correct the line; the file must be one that Python itself can read")
    path = write(tmp_path, "x = 1\0\n")
    assert "error[S102]" in refusal(read.load_file, path, "f")


def test_no_such_function(tmp_path):
    path = write(tmp_path, "def limit(a): return a\ndef step(a): return a\nG = 2\n")
    assert refusal(read.load_file, path, "limt") == (
        f"error[S103]: {path}: no function 'limt' at module level\n"
        "  help: did you mean 'limit'? the file defines: limit, step")
    assert refusal(read.load_file, path, "G") == (
        f"error[S103]: {path}: no function 'G' at module level\n  help: the file defines: limit, step")
    assert refusal(read.load_file, write(tmp_path, ""), "f") == (
        f"error[S103]: {path}: no function 'f' at module level\n  help: the file defines no function at module level")


def test_no_source(tmp_path):
    space = {}
    exec("def made(x):\n    return x\n", space)
    assert refusal(read.load, space["made"]) == (
        "error[S101]: the source of 'made' cannot be had: it was defined in <string>, not in a file\n"
        "  help: write the function to a .py file and import it from there")
    assert refusal(read.load, math.exp) == (
        "error[S101]: 'exp' has no Python source: it is a builtin_function_or_method\n"
        "  help: give a function defined with def in a .py file, which may call it")
    assert refusal(read.load, np.exp) == (
        "error[S101]: 'exp' has no Python source: it is an ufunc\n"
        "  help: give a function defined with def in a .py file, which may call it")
    assert refusal(read.load, 3) == (
        "error[S101]: a function is needed, not an int\n  help: give a function defined with def in a .py file")
    assert refusal(read.load, dict) == (
        "error[S101]: 'dict' is a class, not a function\n  help: give a function defined with def")
    module = imported(write(tmp_path, "class C:\n    def m(self): return 1\n"))
    assert read.load(module.C().m).kernels["m"].parameters == ()


def test_two_lambdas_of_a_line(tmp_path):
    """Since Python 3.11 a function knows in which columns it begins."""
    module = imported(write(tmp_path, "f = [lambda x: x, lambda x: 2 * x]\n"))
    if sys.version_info >= (3, 11):
        assert [s2sad.gradient(f)(3.0) for f in module.f] == [1.0, 2.0]
    else:
        assert refusal(read.load, module.f[0]) == printed(
            module.__file__, 1, "f = [lambda x: x, lambda x: 2 * x]", "lambda x: x", "S101",
            "two lambdas with the same parameters begin in this line", "write it in a line of its own, or with def")


@pytest.mark.parametrize("text", ["", "x = 1\n", "def made(x):\n    return 2 * x\n", "not Python"])
def test_executed_text_is_never_taken_for_the_text_of_a_command(text, monkeypatch):
    """Since Python 3.13 linecache has the text of `python -c` under "<string>", where `exec` puts its functions."""
    monkeypatch.setitem(linecache.cache, "<string>", (len(text), None, text.splitlines(True), "<string>"))
    space = {}
    exec("def made(x):\n    return x\n", space)
    assert refusal(read.load, space["made"]) == (
        "error[S101]: the source of 'made' cannot be had: it was defined in <string>, not in a file\n"
        "  help: write the function to a .py file and import it from there")


def test_function_of_a_command():
    """`python -c` keeps its text since Python 3.13; before, its functions have no source."""
    command = ("from s2sad import S2sadError, read\ndef f(x):\n    return 2.0 * x\n"
               "try:\n    print(read.load(f).entry)\nexcept S2sadError as error:\n    print(error)\n")
    made = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=True)
    expected = "f" if sys.version_info >= (3, 13) else "error[S101]: the source of 'f' cannot be had"
    assert made.stdout.startswith(expected)


def test_helper_without_source_is_shown_at_the_call(tmp_path):
    module = imported(write(tmp_path, "exec('def made(x): return x')\ndef f(x):\n    return made(x)\n"))
    assert refusal(read.load, module.f) == printed(
        module.__file__, 3, "    return made(x)", "made", "S101",
        "the source of 'made' cannot be had: it was defined in <string>, not in a file",
        "write the function to a .py file and import it from there")


def test_file_removed(tmp_path):
    path = write(tmp_path, "def f(x):\n    return x\n")
    module = imported(path)
    path.unlink()
    assert refusal(read.load, module.f) == (
        f"error[S101]: the source of 'f' cannot be had: {path} cannot be read\n"
        "  help: restore the file that the function was imported from")


STALE = "import the module again (importlib.reload, or a new process) and use the function from there"


@pytest.mark.parametrize(("old", "new"), [
    ("return 2.0 * x", "return 3.0 * x"), ("return 2 * x", "return 2.0 * x"), ("return x + y", "return x - y"),
    ("return abs(x)", "return min(x)"), ("z = x\n    return z", "w = x\n    return w"),
    ("return 0.0 * x", "return -0.0 * x"),
    ("g = lambda: 1\n    return g()", "g = lambda: 2\n    return g()"),
])
def test_changed_on_disk(tmp_path, old, new):
    path = write(tmp_path, f"def f(x, y):\n    {old}\n")
    module = imported(path)
    write(tmp_path, f"# a line more, of another length\ndef f(x, y):\n    {new}\n")
    assert refusal(read.load, module.f) == printed(
        path, 2, "def f(x, y):", "f", "S104", "the source of 'f' has changed since the function was defined", STALE
    ).replace("2:3:", "2:5:").replace("  ^\n", "    ^\n")


def test_changed_on_disk_beyond_recognition(tmp_path):
    path = write(tmp_path, "def f(x):\n    return x\n")
    module = imported(path)
    write(tmp_path, "def g(x, y):\n    return x\n")
    text = f"error[S104]: {path}: the source of 'f' has changed since the function was defined\n  help: {STALE}"
    assert refusal(read.load, module.f) == text
    write(tmp_path, "def f(x):\n    return x +* 2 # not Python now\n")
    assert refusal(read.load, module.f) == text


def test_changed_elsewhere_is_no_matter(tmp_path):
    path = write(tmp_path, "def f(x):\n    return 2.0 * x\n")
    module = imported(path)
    write(tmp_path, "def f(x):\n    return 3.0 * x\n\n\ndef g(x):\n    pass\n\n\ndef f(x):\n    return 2.0 * x\n")
    assert read.load(module.f).kernels["f"].tree.lineno == 9
