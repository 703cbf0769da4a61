"""Files, functions, options and commands that cannot be meant: messages and exit statuses."""
from __future__ import annotations

import pytest

from tests.cli.files import SCALE


def test_a_file_that_is_not_python(ran, kernel):
    kernel("def f(x:\n    return x\n")
    status, out, err = ran("adjoint", "k.py:f")
    assert (status, out) == (1, "")
    assert err.startswith("k.py:1:6: error[S102]: not Python: '(' was never closed\n  1 | def f(x:\n")


def test_a_file_that_is_missing_a_directory_or_not_utf8(ran, kernel, tmp_path):
    kernel(SCALE)
    (tmp_path / "bad.py").write_bytes(b"# first\n# second\nx = '\xff'\n")
    assert ran("adjoint", "none.py:f") == (1, "", "error[S101]: none.py: no such file\n"
                                           "  help: check the path, which is relative to the working directory\n")
    assert ran("adjoint", ".:f") == (1, "", "error[S101]: .: this is a directory\n"
                                     "  help: give a Python file: kernel.py:function\n")
    assert ran("adjoint", "bad.py:f") == (
        1, "", "bad.py:3:6: error[S101]: not UTF-8 (byte 0xff)\n  3 | x = '\ufffd'\n    |      ^\n"
        "  help: save the file as UTF-8, or name its encoding in the first line: # -*- coding: latin-1 -*-\n")


def test_a_function_that_is_not_in_the_file(ran, kernel):
    kernel(SCALE)
    assert ran("adjoint", "k.py:scal") == (1, "", "error[S103]: k.py: no function 'scal' at module level\n"
                                           "  help: did you mean 'scale'? the file defines: scale\n")


def test_wrt_that_cannot_be_meant(ran, kernel):
    kernel("def f(u, n):\n    total = 0.0\n    for i in range(n):\n        total += u[i]\n    return total\n")
    assert ran("adjoint", "k.py:f", "--wrt", "v") == (
        1, "", "error[S401]: wrt names 'v', which is no parameter of 'f'\n  help: its parameters are u, n\n")
    assert ran("adjoint", "k.py:f", "--wrt", "n") == (
        1, "", "error[S401]: wrt names 'n', which is an integer\n"
        "  help: give a float (3.0, not 3) if it is a real quantity\n")
    assert ran("adjoint", "k.py:f", "--of", "u")[2].startswith(
        "error[S401]: 'u' is no output of 'f', which does not write it\n")


def test_wrt_that_no_output_depends_on_is_a_warning(ran, kernel):
    kernel("def f(u, c):\n    return u[0]\n")
    status, out, err = ran("adjoint", "k.py:f", "--wrt", "u,c")
    assert status == 0 and "c_bar = 0.0" in out
    assert err == "warning[S401]: no output asked for of 'f' depends on 'c': its gradient is zero\n"
    assert ran("adjoint", "k.py:f")[2] == ""


@pytest.mark.parametrize(("options", "message"), [
    (("k.py",), "'k.py' names no function at module level; k.py defines   s2sad adjoint k.py:scale"),
    (("k.py:",), "'k.py:' names no function at module level; k.py defines   s2sad adjoint k.py:scale"),
    (("k.py:C.scale",), "'k.py:C.scale' names no function at module level; k.py defines   s2sad adjoint k.py:scale"),
    (("k",), "'k' is not FILE:FUNCTION, as kernel.py:step"),
    (("k.py:scale", "--types", "u: flaot64[:]"), "--types: 'flaot64[:]' is no type for 'u'; use float64, float32, "
     "complex128, int64 or bool, an array of these, as float64[:, :], or a structure, as {u: float64[:], t: float}"),
    (("k.py:scale", "--types", "float64"), "--types: 'float64' is not NAME: TYPE, as u: float64[:, :]"),
    (("k.py:scale", "--types", "v: float64"), "--types names 'v', which is no parameter of 'scale': its parameters are "
     "u, c"),
    (("k.py:scale", "--engine", "jax"), "argument --engine: invalid choice: 'jax'"),
])
def test_wrong_usage(ran, kernel, options, message):
    kernel(SCALE)
    status, out, err = ran("adjoint", *options)
    assert (status, out) == (2, "") and message in err.replace("\n", " ")
    assert ran("stages", "k.py:scale", "--after", "supper")[0] == 2


def test_a_word_that_is_no_command(ran, kernel):
    kernel(SCALE)
    for words, message in ((("adjont", "k.py:scale"), "there is no command 'adjont'; did you mean 'adjoint'?"),
                           (("k.py:scale", "--wrt", "u"), "a command is missing: s2sad adjoint k.py:scale"),
                           (("k.py",), "a command is missing: s2sad adjoint k.py"),
                           (("supper",), "there is no command 'supper': the commands are adjoint, tangent, explain, "
                            "stages, check, bench, cache")):
        status, out, err = ran(*words)
        assert (status, out) == (2, "") and err.endswith(f"s2sad: error: {message}\n")


def test_a_file_without_functions_has_none_to_list(ran, kernel):
    kernel("x = 1\n")
    status, _, err = ran("adjoint", "k.py")
    assert status == 2 and err.endswith("'k.py' names no function, and k.py defines none at module level\n")
    assert ran("adjoint", "none.py")[::2] == (1, "error[S101]: none.py: no such file\n  help: check the path, which is "
                                              "relative to the working directory\n")


def test_a_check_that_cannot_run(ran, kernel):
    kernel("def f(u, n):\n    return u[7 * n]\n")
    status, out, err = ran("check", "k.py:f", "--engine", "numpy")
    assert (status, out) == (1, "")
    assert "error[S405]: 'f' raised IndexError on made-up arguments: index 21 is out of bounds" in err
    kernel("1 / 0\n" + SCALE, "broken.py")
    assert "error[S101]: broken.py: raised ZeroDivisionError when it was run" in ran("check", "broken.py:scale")[2]
    assert "error[S405]: --arguments: NameError: name 'q'" in ran("check", "k.py:f", "--arguments", "q")[2]
