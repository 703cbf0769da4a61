"""What was derived is handed on to later processes, and to none that would derive something else."""
from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import s2sad
from s2sad.dispatch import artifacts
from s2sad.diagnostics import warn_once
from s2sad.live_objects.registry import GIVEN
from s2sad.run import store
from s2sad.rules.rule import TABLE
from tests.harness.documents import ROOT
from tests.dispatch.processes import HELPERS, KERNEL


def slope(f, *args, wrt="x", **options):
    return s2sad.gradient(s2sad.differentiate(f, engine="numpy", **options), wrt=wrt)(*args)


def test_another_process_derives_nothing(processes):
    for _ in range(2):
        module = processes.fresh()
        assert slope(module.f, 2.0) == 2.0 * 4.0 * 3.0 * 5.0 * 1.5 * 3.0
        assert slope(module.structured, 2.0, module.Params()) == 3.0 * 4.0 * 3.0
        assert slope(module.structured, 2.0, module.Params(), wrt="p").k == 4.0 * 3.0
        assert slope(module.made, 2.0) == 7.0
        assert slope(module.through, 2.0) == slope(module.MODEL.energy, 2.0) == 6.0
        assert slope(module.with_function, 2.0) == slope(module.applied, module.helper, 2.0) == 4.0
        assert slope(module.summed, np.ones(2), wrt="u").tolist() == [4.0, 4.0]
        assert s2sad.jvp(s2sad.differentiate(module.pair, engine="numpy"), (2.0, 3.0), {"x": 1.0}) == {"return": 12.0}
    assert processes.warm


TAPED = """

def powers(u, n):
    for k in range(n):
        for i in range(u.size):
            u[i] = u[i] * u[i]
    return u[0]
"""


@pytest.mark.parametrize("checkpoint", [None, {"k": 1}])
def test_a_tape_and_snapshots_are_those_of_the_first_process(checkpoint, processes):
    """With what is known of them before a run."""
    processes.write(KERNEL + TAPED)
    takes = set()
    for _ in range(2):
        f = s2sad.differentiate(processes.fresh().powers, engine="numpy", checkpoint=checkpoint)
        takes.add(str(f.adjoint.memory(np.ones(100), 64)))
        assert s2sad.gradient(f, wrt="u")(np.array([1.5, 2.0]), 2).tolist() == [4.0 * 1.5 ** 3, 0.0]
    assert processes.warm and len(takes) == 1


CHANGES = {
    "a helper's text": (lambda p: p.write(helpers=HELPERS.replace("x ** power", "x * power")), "f", (2.0,), 270.0),
    "a helper's default": (lambda p: p.write(helpers=HELPERS.replace("power=2", "power=3")), "f", (2.0,), 1620.0),
    "a comment": (lambda p: p.write(KERNEL + "# more\n"), "f", (2.0,), 540.0),
    "a constant": (lambda p: p.write(KERNEL.replace("G = 2.0", "G = 4.0")), "f", (2.0,), 1080.0),
    "an integer in its place": (lambda p: p.write(KERNEL.replace("G = 2.0", "G = 2")), "f", (2.0,), 540.0),
    "an item": (lambda p: p.write(helpers=HELPERS.replace('"a": 3.0', '"a": 6.0')), "f", (2.0,), 1080.0),
    "an attribute": (lambda p: p.write(helpers=HELPERS.replace("b=5.0", "b=10.0")), "f", (2.0,), 1080.0),
    "a default of the kernel": (lambda p: p.write(KERNEL.replace("c=1.5", "c=3.0")), "f", (2.0,), 1080.0),
    "an array of another type": (
        lambda p: p.write(KERNEL.replace("[1.0, 2.0]", "[[1.0, 2.0]]")), "f", (2.0,), 540.0),
    "a default of a dataclass": (
        lambda p: p.write(helpers=HELPERS.replace("b: float = 7.0", "b: float = 8.0")), "made", (2.0,), 8.0),
    "a field more": (lambda p: p.write(helpers=HELPERS.replace("    b: float", "    c: float = 4.0\n    b: float")),
                     "made", (2.0,), 7.0),
    "a class attribute": (lambda p: p.write(KERNEL.replace("scale = 2.0", "scale = 5.0")), "through", (2.0,), 15.0),
    "an attribute of an object": (
        lambda p: p.write(KERNEL.replace("self.k = 3.0", "self.k = 4.0")), "through", (2.0,), 8.0),
    "a method of an object": (
        lambda p: p.write(KERNEL.replace("return self.k", "return 2.0 * self.k")), "through", (2.0,), 12.0),
    "a method that is patched": (
        lambda p: p.write(KERNEL + "\nModel.factor = lambda self: 9.0\n"), "through", (2.0,), 18.0),
}


@pytest.mark.parametrize("title", CHANGES)
def test_what_has_changed_is_derived_anew(title, processes):
    change, name, args, right = CHANGES[title]
    slope(getattr(processes.fresh(), name), *args)
    change(processes)
    assert slope(getattr(processes.fresh(), name), *args) == right and not processes.warm
    assert slope(getattr(processes.fresh(), name), *args) == right and processes.warm
    processes.write()
    if title != "a comment":
        before = getattr(processes.fresh(), name)
        assert slope(before, *args) == slope(before, *args)
        assert processes.warm       # both are kept


LIKE_ITSELF = """
class {0}({0}):
    def __repr__(self):
        return "itself"
value = {0}({1!r})
"""


@pytest.mark.parametrize("kind, values", [("float", (2.0, 3.0)), ("int", (2, 3)), ("str", ("a", "b"))])
def test_numbers_and_strings_are_not_told_by_what_they_say_of_themselves(kind, values, processes):
    said = "(2.0 if helpers.value == 'a' else 3.0)" if kind == "str" else "helpers.value"
    kernel = f"import helpers_of_artifacts as helpers\ndef f(x):\n    return x * {said}\n"
    for value, right in zip(values * 2, (2.0, 3.0) * 2):
        processes.write(kernel, LIKE_ITSELF.format(kind, value))
        assert slope(processes.fresh().f, 1.0) == right
    assert processes.warm


def test_an_array_is_read_as_it_is(processes):
    assert slope(processes.fresh().f, 2.0) == 540.0
    module = processes.fresh()
    module.WEIGHTS[:] = [2.0, 4.0]
    assert slope(module.f, 2.0) == 1080.0 and processes.warm


def test_what_is_set_before_the_first_call_is_seen(processes):
    slope(processes.fresh().f, 2.0)
    module = processes.fresh()
    module.G = 4.0
    assert slope(module.f, 2.0) == 1080.0 and not processes.warm
    module = processes.fresh()
    g = s2sad.gradient(s2sad.differentiate(module.f, engine="numpy"), wrt="x")
    assert g(2.0) == 540.0 and processes.warm
    module.G = 8.0
    assert g(2.0) == 2160.0 and not processes.warm


def test_refusals_are_those_of_the_first_process(processes):
    for _ in range(3):
        module = processes.fresh()
        with pytest.raises(s2sad.S2sadError, match="S406") as caught:
            s2sad.autodiff(s2sad.Reverse, s2sad.differentiate(module.through_work, engine="numpy"), s2sad.Active(2.0),
                           s2sad.Const(np.zeros(1)))
        assert "work[0] = x * x" in str(caught.value)
        with pytest.raises(s2sad.S2sadError, match="S401"):
            s2sad.gradient(s2sad.differentiate(module.summed, engine="numpy"), wrt="v")(np.ones(2))
        with pytest.raises(s2sad.S2sadError, match="S405"):
            s2sad.gradient(s2sad.differentiate(module.summed, engine="numpy"))(np.ones(2, complex).astype("c8"))


def test_shadows_seeds_and_tangents_of_a_second_process(processes):
    for _ in range(2):
        module = processes.fresh()
        f = s2sad.differentiate(module.through_work, engine="numpy")
        work, bar = np.zeros(1), np.zeros(1)
        assert f.adjoint(3.0, work, bar, 1.0) == (12.0,)
        assert f.tangent(3.0, 1.0, np.zeros(1), np.zeros(1)) == (12.0,)
        f = s2sad.differentiate(module.structured, engine="numpy")
        p_bar = s2sad.make_zero(module.Params())
        assert s2sad.autodiff(s2sad.Reverse, f, s2sad.Active(2.0), s2sad.Duplicated(module.Params(), p_bar)) == (36.0,)
        assert p_bar.k == 12.0
    assert processes.warm


def test_warnings_are_those_of_the_first_process(processes):
    for _ in range(2):
        warn_once.cache_clear()
        with pytest.warns(s2sad.S2sadWarning, match="derivatives do not print this"):
            assert slope(processes.fresh().talking, 2.0) == 4.0
    assert processes.warm


def test_the_compiler_reads_what_was_taken_and_nothing_else(processes):
    slope(processes.fresh().f, 2.0)
    module = processes.fresh()
    f = s2sad.differentiate(module.f, engine="numpy")
    assert slope(f, 2.0) == 540.0 and processes.warm
    assert s2sad.vjp(f, (2.0, 1.5), {"return": 1.0}, wrt="c") == {"c": 720.0 / 2.0} and processes.read
    assert slope(f, 2.0) == 540.0


def test_other_types_and_other_questions_are_others(processes):
    slope(processes.fresh().summed, np.ones(2), wrt="u")
    module = processes.fresh()
    assert slope(module.summed, np.ones(2, np.float32), wrt="u").dtype == np.float32 and processes.derived
    slope(processes.fresh().pair, 2.0, 3.0)
    assert slope(processes.fresh().pair, 2.0, 3.0, wrt="y") == 4.0 and processes.derived
    slope(processes.fresh().picks, 2.0, 3)
    assert slope(processes.fresh().picks, 2.0, 3.0) == 12.0 and processes.derived
    module = processes.fresh()
    assert s2sad.value_and_gradient(s2sad.differentiate(module.pair, engine="numpy"), wrt="x")(2.0, 3.0) == (12.0, 12.0)


@pytest.mark.parametrize(("keys", "expected"), [((np.int64(1),), 1.0), ((np.str_("b"),), 4.0), ({"b"}, 4.0)], ids=repr)
def test_arguments_that_no_description_identifies_are_evaluated_in_each_process(keys, expected, processes):
    for _ in range(2):
        assert slope(processes.fresh().found, np.array([2.0]), keys) == [expected] and processes.derived


@pytest.fixture
def registry():
    given = dict(GIVEN.by_path), dict(GIVEN.by_identity)
    rules, constants = dict(TABLE.rules), dict(TABLE.constants)
    yield
    for table, before in ((GIVEN.by_path, given[0]), (GIVEN.by_identity, given[1]), (TABLE.rules, rules),
                          (TABLE.constants, constants)):
        table.clear()
        table.update(before)
    GIVEN.edition += 1


def test_derivatives_of_the_users_own_are_asked_for(processes, registry):
    slope(processes.fresh().f, 2.0)
    module = processes.fresh()
    s2sad.rule("helpers_of_artifacts.helper(x)", x="5.0", check=False)
    assert slope(module.f, 2.0) == 2.0 * 5.0 * 3.0 * 5.0 * 1.5 * 3.0 and not processes.warm
    module = processes.fresh()
    s2sad.nondifferentiable(module.helper)
    assert slope(module.f, 2.0) == 0.0 and not processes.warm


def test_damage_is_a_miss(processes, monkeypatch):
    slope(processes.fresh().f, 2.0)
    entries = sorted(Path(store.folder()).glob("*.derived"))
    assert entries
    for position in (0, 20, 60, -5):
        for entry in entries:
            content = bytearray(entry.read_bytes())
            content[position] ^= 1
            entry.write_bytes(bytes(content))
        assert slope(processes.fresh().f, 2.0) == 540.0 and not processes.warm


@pytest.mark.parametrize("planted", [b"", b"[]", b"{", b"[\"tuple\"]", b"[\"Type\"]", b"[\"class\",\"os\",\"nothing\"]",
                                     b"[\"tuple\",[\"tuple\",1,2,3]]", b"3", b"[[]]", b"[\"dict\",1]"])
def test_what_is_no_entry_is_a_miss(planted, processes, monkeypatch):
    """Even with a checksum that fits."""
    slope(processes.fresh().f, 2.0)
    monkeypatch.setattr(store, "get", lambda key, kind="data": planted)
    assert slope(processes.fresh().f, 2.0) == 540.0


def test_every_module_of_the_package_is_part_of_the_key():
    package = Path(s2sad.__file__).parent
    assert [path for path, *_ in artifacts._package_files()] == sorted(map(str, package.rglob("*.py")))


def test_numbers_come_back_as_they_were():
    values = (0.0, -0.0, float("inf"), 1e-300, 3, True, None, "a", 2j, {"a": (1, [2.5])}, ...)
    again = artifacts._value(json.loads(artifacts._text(values)))
    assert repr(again) == repr(values)
    assert np.isnan(artifacts._value(json.loads(artifacts._text(float("nan")))))


SCRIPT = """
import sys
import numpy as np, s2sad, kernel_of_artifacts as k
print(s2sad.gradient(s2sad.differentiate(k.structured, engine="numpy"), wrt="x")(2.0, k.Params()))
print("s2sad.pipeline" in sys.modules, "gast" in sys.modules)
f = s2sad.differentiate(k.structured, engine="numpy")
print("def structured_adjoint" in f.adjoint_source(2.0, k.Params()), "s2sad.pipeline" in sys.modules)
"""


def test_a_process_that_finds_everything_goes_without_the_compiler(processes, tmp_path):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])}
    runs = [subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, env=environment,
                           check=True).stdout.split() for _ in range(2)]
    assert runs == [["36.0", "True", "True", "True", "True"], ["36.0", "False", "False", "True", "True"]]


KEYED = """
import enum

Kind = enum.Enum("Kind", "ION ATOM")
BONDS = {(Kind.ION, 1): 3.0}


def bonded(x):
    return BONDS[Kind.ION, 1] * x * x
"""


def test_keys_that_nothing_identifies_elsewhere(processes):
    processes.write(KERNEL + KEYED)
    assert slope(processes.fresh().bonded, 2.0) == 12.0
