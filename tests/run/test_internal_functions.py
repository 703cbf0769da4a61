"""Functions that compiled code alone calls have no machine code of their own."""
from __future__ import annotations

import importlib
import re
import sys

import numpy as np
import pytest

from s2sad.run import compiled as engine, internal_functions
from tests.run.test_store import files

pytestmark = pytest.mark.usefixtures("location")
numba = pytest.importorskip("numba")
TEXT = """import numpy as np


def inner(x, k):
    if k < 0:
        print("negative", k)
        raise ValueError("k is negative")
    return x[k] / 3.0


def middle(x, k):
    return inner(x, k) + inner(x, k + 1)


def first(x, k):
    return middle(x, k)


def second(x, k):
    return 2.0 * middle(x, k) - inner(x, 0)
"""


def made(name):
    """The module, loaded anew."""
    sys.modules.pop(next((n for n in sys.modules if n.startswith(f"s2sad_{name}_")), ""), None)
    return engine.compiled(TEXT, name, entries=["first", "second"])


def test_what_python_calls_is_compiled_with_all_that_it_consists_of():
    module, x = made("sums"), np.array([3.0, 6.0, 9.0])
    assert module.first(x, 0) == 3.0 and module.second(x, 1) == 9.0
    for function, wrapped in ((module.inner, False), (module.first, True)):
        for result in function.overloads.values():
            defined = result.library.codegen._engine.is_symbol_defined
            assert defined(result.fndesc.llvm_cpython_wrapper_name) is wrapped


def test_python_cannot_call_an_internal_function():
    module, x = made("called"), np.ones(2)
    module.first(x, 0)
    with pytest.raises(TypeError):
        module.inner(x, 0)
    with pytest.raises(TypeError):
        made("not_yet_compiled").middle(x, 0)


def test_what_they_raise_and_print_comes_out_compiled_and_from_disk(location, capfd):
    x = np.ones(2)
    for _ in range(2):
        module = made("raises")
        with pytest.raises(ValueError, match="k is negative"):
            module.first(x, -1)
        assert "negative -1" in capfd.readouterr().out
    assert sum(module.first.stats.cache_hits.values()) == 1
    assert len(files(location, "code")) == 1        # internal ones are in what calls them


def test_they_check_bounds_where_it_is_asked():
    module = engine.compiled(TEXT, "checked", bounds=True, entries=["first"])
    with pytest.raises(IndexError):
        module.first(np.ones(2), 1)


def test_under_another_numba_all_functions_are_compiled_alike(monkeypatch):
    internal_functions.options.cache_clear()
    monkeypatch.delattr(importlib.import_module("numba.core.typed_passes"), "NativeLowering")
    try:
        assert internal_functions.options() == ({}, {})
        module, x = made("other"), np.array([3.0, 6.0])
    finally:
        internal_functions.options.cache_clear()
    monkeypatch.undo()
    assert module.inner(x, 0) == 1.0 and module.first(x, 0) == 3.0


def test_arrays_that_share_no_memory_are_known_to_llvm():
    """Of the data of arrays only: an array and its rows have one owner."""
    x = np.ones(3)
    for name, distinct in (("apart", ["first", "inner"]), ("aliases", [])):
        module = engine.compiled(TEXT, name, entries=["first"], distinct=distinct)
        module.first(x, 0)
        [text] = module.first.inspect_llvm().values()
        heads = [line for line in text.splitlines() if line.startswith("define") and "%arg.x.4" in line]
        assert heads and all(bool(re.search("noalias[^,]* %arg.x.4", line)) is bool(distinct) for line in heads)
        assert not any(re.search("noalias[^,]* %arg.x.0", line) for line in heads)


WRITTEN = """import numpy as np


def count(shape, k):
    return shape[0] * shape[1] + k


def along(x, k):
    return np.concatenate((x, x), axis=k)


def item(pair, k):
    return pair[k]


def entry(x, n):
    return (count((n, 2), 0) + count((3, n), 1) + count((n, n), n) + along(x, 1).size + along(x, 0).shape[0]
            + item((x, 7), 0).size + item((x, n), 1))
"""


def test_integers_that_calls_write_are_one_type_where_they_may_be():
    module = engine.compiled(WRITTEN, "written", entries=["entry"])
    assert module.entry(np.ones((2, 3)), 4) == 8 + (12 + 1) + (16 + 4) + 12 + 4 + 6 + 4
    assert len(module.count.signatures) == 1
    assert len(module.item.signatures) == 2     # the items are of different types
