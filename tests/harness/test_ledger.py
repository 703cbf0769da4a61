"""The ledger: kernels are known wherever they are, are replayed as they were asked for, and what moves is said."""
from __future__ import annotations

import functools
import importlib.util
import pickle
from dataclasses import dataclass, replace
from types import ModuleType

import numpy as np
import pytest

import s2sad
from s2sad import S2sadError, pipeline
from tests.ledger.collect import Collector, collecting
from tests.ledger.compare import is_hash, compare
from tests.ledger.identity import described, digest
from tests.ledger.replay import Replay, Row
from tests.ledger.store import Kernel, Store, pickled, unpickled

SOURCE = """
{before}
SCALE = {scale}

def helper(a):
    return SCALE * a

def kernel(x):
    return helper(x) * x
"""


@dataclass
class Oscillator:
    position: float
    stiffness: float

    def loss(self, x):
        return self.stiffness * x ** 2

    def __call__(self, x):
        return self.stiffness * x ** 3


def halved_adjoint(u, u_bar, result_bar):
    u_bar += 0.5 * result_bar


@s2sad.rule(adjoint=halved_adjoint)
def halved(u):
    return 0.5 * np.sum(u)


def scaled(x, factor):
    return factor * x ** 2


def energy(o):
    return 0.5 * o.stiffness * o.position ** 2


def moved_oscillator(o, dt):
    return Oscillator(o.position + dt, o.stiffness).position


FREE = Oscillator(1.0, 2.0)


def with_rule(u):
    return halved(u) ** 2


def refused(x):
    return np.partition(x, 1)[0]


def module(path, **values) -> ModuleType:
    path.write_text(SOURCE.format(**values))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def collected(*calls) -> Store:
    """What the compiler is asked for by gradients of functions at arguments."""
    collector = Collector()
    with collecting(collector):
        for function, args in calls:
            try:
                s2sad.gradient(s2sad.differentiate(function, engine="numpy"))(*args)
            except S2sadError:
                pass
    assert not collector.missed
    return collector.store


def rows_of(store: Store) -> dict[str, list[Row]]:
    return {k.name: Replay(k, store.texts).rows() for k in store.kernels.values()}


@pytest.mark.parametrize("function, args", [
    (energy, (Oscillator(1.0, 2.0),)), (moved_oscillator, (Oscillator(1.0, 2.0), 0.5)), (with_rule, (np.ones(3),)),
    (FREE.loss, (0.5,)), (FREE, (0.5,)), (functools.partial(scaled, factor=3.0), (0.5,))])
def test_a_replay_gives_the_text_that_the_test_was_given(tmp_path, function, args):
    collector, texts = Collector(), []
    with pytest.MonkeyPatch.context() as patch:
        inner = pipeline.derive

        def kept(program, request, *given, **named):
            made = inner(program, request, *given, **named)
            texts.append((request, made.text))
            return made
        patch.setattr(pipeline, "derive", kept)
        with collecting(collector):
            s2sad.rule(halved, adjoint=halved_adjoint)
            s2sad.gradient(s2sad.differentiate(function, engine="numpy"))(*args)
    collector.store.write(f"{tmp_path}/a.store")
    ((found,),) = rows_of(Store.read(f"{tmp_path}/a.store")).values()
    ((request, text),) = texts
    assert found.cells[("plain", "fast").index(request.level) + 1] == digest(text)
    assert all(map(is_hash, found.cells))
    assert Row.of(str(found)) == found


def test_a_refusal_has_its_code():
    ((row,),) = rows_of(collected((refused, (np.ones(3),)))).values()
    assert set(row.cells) == {"S301"}


def test_a_kernel_is_known_wherever_it_is_and_by_what_it_reads(tmp_path):
    here = module(tmp_path / "here.py", before="", scale=2.0).kernel
    there = module(tmp_path / "there.py", before="# moved\n" * 9, scale=2.0).kernel
    other = module(tmp_path / "other.py", before="", scale=3.0).kernel
    first, second, third = (set(collected((f, (1.5,))).kernels) for f in (here, there, other))
    assert first == second and first.isdisjoint(third)
    assert described(here) == described(there) != described(other)


def test_a_store_takes_what_another_process_has_collected(tmp_path):
    kernel = module(tmp_path / "one.py", before="", scale=4.0).kernel
    both, more = collected((kernel, (1.5,))), collected((refused, (np.ones(3),)))
    both.add(more)
    assert {k.name for k in both.kernels.values()} == {"kernel", "refused"}


def test_what_moved_is_said():
    row = Row("0" * 12, "f", "adjoint(x -> return)", ("0" * 12,) * 6, "here:1")
    another, lost = replace(row, cells=("1" * 12, *row.cells[1:])), replace(row, cells=("S201",) * 6)
    assert not compare([row], [replace(row, places="there:2")]).kinds
    assert list(compare([row], [another]).kinds) == ["another text"]
    assert list(compare([row], [lost]).kinds) == ["refused (S201)"]
    assert list(compare([lost], [row]).kinds) == ["accepted"]
    assert list(compare([], [row]).kinds) == ["added"] and list(compare([row], []).kinds) == ["lost"]
    assert "[numpy structured]" in str(compare([row], [another]))


def test_what_the_package_has_moved_is_found_where_it_is():
    content = pickled((S2sadError, []))[0].replace(b"s2sad.diagnostics", b"s2sad.complaining")
    kernel = Kernel("", "", content, {})
    gone = Kernel("", "", pickle.dumps((np.float64, [])).replace(b"numpy", b"s2sad"), {})
    assert unpickled(kernel, {}) == [S2sadError]
    with pytest.raises(AttributeError, match="has 0 of 'float64'"):
        unpickled(gone, {})
