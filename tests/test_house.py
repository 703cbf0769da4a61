"""The house keeps its order: rooms that can be surveyed, names that occur once, and passes that show what they do."""
from __future__ import annotations

import inspect
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from s2sad.passes import each
from tests.harness.documents import ROOT
from tests.harness.pictures import LISTS, Picture, document, functions, pictures, wrong
from tests.harness.rooms import layers

PACKAGE, TESTS = ROOT / "s2sad", ROOT / "tests"
# tests of the whole, and folders of tests that belong to no room alone
OF_THE_WHOLE = ("corpus", "examples", "golden", "house", "long_kernels", "passes", "random_programs", "simulations")
FOLDERS = ("benchmarks", "corpus", "docs", "golden", "harness", "ledger", "programs", "simulations")
# passes that leave facts in the context and the tree as it is
FACTS = ("reported_types", "inferred_types", "primal_form", "same_primal", "program_structure", "activity",
         "unbounded_values", "to_be_recorded", "entry_dtypes", "commuting_iterations")
# passes on functions with a derivative of the user's own: a file that is only read has none
LIVE = ("unsupported_derivatives",)
# rooms in which modules have the names of what they are for, as other modules have
CONVENTIONS = ("infer/signatures", "normalize/library/expansions", "rules", "runtime")


def modules() -> Iterator[Path]:
    yield from (p.relative_to(PACKAGE) for p in PACKAGE.rglob("*.py"))


def test_no_two_modules_share_a_name():
    found: defaultdict[str, list[Path]] = defaultdict(list)
    for path in modules():
        if path.parent.as_posix() not in CONVENTIONS and path.stem not in ("__init__", "context"):
            found[path.stem].append(path)
    assert {n: list(map(str, paths)) for n, paths in found.items() if len(paths) > 1} == {}


def test_no_folder_is_large():
    folders: defaultdict[Path, int] = defaultdict(int)
    for path in modules():
        folders[path.parent] += 1
    assert {str(f): n for f, n in folders.items() if n > 30} == {}


def test_tests_lie_in_the_folder_of_their_room():
    paths = [p.relative_to(TESTS) for p in TESTS.rglob("*.py")]
    folders = {p.parts[0] for p in paths if len(p.parts) > 1}
    assert folders - {p.parts[0] for p in modules() if len(p.parts) > 1} == set(FOLDERS)
    alone = {p.stem for p in paths if len(p.parts) == 1} - {"__init__", "conftest"}
    assert alone == {f"test_{name}" for name in OF_THE_WHOLE}


def test_the_contract_has_few_layers():
    assert len(layers()) <= 23


def test_the_names_of_passes_are_their_stages():
    titles = [step.title for passes in LISTS[:2] + LISTS[4:6] + LISTS[7:] for step in each(passes)]
    assert len(titles) == len(set(titles))


@pytest.mark.parametrize("function", functions(), ids=lambda f: f.__name__)
def test_a_pass_says_what_it_requires_and_establishes(function: Callable[..., Any]):
    said = f"{sys.modules[function.__module__].__doc__} {inspect.getdoc(function)}".lower()
    assert "requires" in said and any(word in said for word in ("establish", "changes nothing"))


def shown() -> Iterator[Any]:
    for function in functions():
        for number, picture in enumerate(pictures(document(function))):
            yield pytest.param(function, picture, id=f"{function.__name__}-{number}")


@pytest.mark.parametrize(("function", "picture"), list(shown()))
def test_a_picture_shows_what_the_pass_does(function: Callable[..., Any], picture: Picture):
    said = wrong(function, picture)
    assert not said, said


def test_every_pass_has_a_picture():
    missing = [f.__name__ for f in functions() if not any(True for _ in pictures(document(f)))]
    assert [n for n in missing if n not in FACTS + LIVE] == []
