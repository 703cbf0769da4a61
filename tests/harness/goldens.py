"""Goldens: small kernels, and beside each the texts that the stages make of it, compared as text and run.

`tests/golden/<case>/given.py` holds a kernel with one feature, and what to differentiate: `ARGUMENTS`, `WRT`, `OF`.
Beside it lie

    normal.py         the kernel in normal form
    adjoint.py        the adjoint for NumPy, plain
    adjoint_fast.py   the adjoint for Numba, fast, where its functions are not the plain ones
    tangent.py        the tangent for NumPy, plain

`pytest --update-golden` writes them anew (not where CI is set) and `python -m tests.harness.goldens` prints how the
texts that are made now differ from them.
"""
from __future__ import annotations

import copy
import difflib
import importlib.util
import inspect
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from s2sad import pipeline
from s2sad.dispatch import compiler
from s2sad.dispatch.arguments import bind
from s2sad.emit import module_text
from s2sad.interface.pytrees import flatten
from s2sad.infer.types import of_value
from s2sad.program import Generated, Program, Request
from s2sad.tree import FunctionDef
from s2sad.units import Unit
from s2sad.dispatch.cache import ProgramVersion

FOLDER = Path(__file__).resolve().parents[1] / "golden"
CASES = sorted(path.name for path in FOLDER.iterdir() if path.is_dir() and not path.name.startswith((".", "_")))
FILES = ("normal.py", "adjoint.py", "adjoint_fast.py", "tangent.py")


class Given(NamedTuple):
    """A case as given: its module, its program, its kernel and arguments without structures, and the plain requests for
    its derivatives."""
    module: ModuleType
    program: Program
    kernel: Callable[..., Any]
    arguments: tuple[Any, ...]
    adjoint: Request
    tangent: Request


class Made(NamedTuple):
    """What the stages make of a case: the texts by file, the entry in normal form, the signatures by file."""
    texts: dict[str, str]
    normal: str
    signatures: dict[str, Generated]


@cache
def given(case: str) -> Given:
    path = FOLDER / case / "given.py"
    spec = importlib.util.spec_from_file_location(f"tests.golden.{case}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    program, kernel, arguments = compiler.program(module.kernel), module.kernel, module.ARGUMENTS
    apart = flatten(ProgramVersion.of(program, kernel), arguments)
    if apart is not None:
        arguments = bind(program.kernels[program.entry], arguments)
        program, kernel = apart.state.program, apart.flat_function(kernel, copy.deepcopy(arguments))
        kinds = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_ONLY) for name in apart.paths]
        vars(kernel)["__signature__"] = inspect.Signature(kinds)
        arguments = tuple(apart.values(arguments))
    types = tuple(of_value(a) if apart is None else of_value(a).plain for a in arguments)
    adjoint, tangent = (Request(mode, types, module.WRT, module.OF) for mode in ("adjoint", "tangent"))
    return Given(module, program, kernel, arguments, adjoint, tangent)


@cache
def made(case: str) -> Made:
    program, (adjoint, tangent) = given(case).program, given(case)[-2:]
    units, unit = pipeline.entry(program, adjoint.types, "numpy")
    normal = module_text([titled(u) for u in units.titled.values()], constants=program.constants, standalone=False,
                         header=["Normal form."])
    fast = Request("adjoint", adjoint.types, adjoint.wrt, adjoint.of, "numba", "fast")
    signatures = {"adjoint.py": pipeline.derive(program, adjoint), "adjoint_fast.py": pipeline.derive(program, fast),
                  "tangent.py": pipeline.derive(program, tangent)}
    texts = {"normal.py": normal, **{name: generated.text for name, generated in signatures.items()}}
    if functions(texts["adjoint_fast.py"]) == functions(texts["adjoint.py"]):
        del texts["adjoint_fast.py"]
    return Made(texts, unit.title, signatures)


def titled(unit: Unit) -> FunctionDef:
    """A kernel in normal form, under the name by which others call it."""
    renamed = copy.copy(unit.function)
    renamed.name = unit.title
    return renamed


def functions(text: str) -> str:
    """A module's text without its docstring."""
    return text.split('"""', 2)[2]


def golden(case: str, name: str) -> str:
    """A golden file's text; of a fast text that is the plain one, the plain file's."""
    path = FOLDER / case / name
    if name == "adjoint_fast.py" and not path.exists():
        path = FOLDER / case / "adjoint.py"
    return path.read_text(encoding="utf-8")


def update(case: str) -> None:
    """Writes the files of a case, and removes those that no stage writes any longer."""
    texts = made(case).texts
    for name in FILES:
        path = FOLDER / case / name
        if name not in texts:
            path.unlink(missing_ok=True)
        elif not path.exists() or path.read_text(encoding="utf-8") != texts[name]:
            path.write_text(texts[name], encoding="utf-8")


def difference(case: str) -> str:
    """How the files of a case differ from the texts that are made now; a file that is missing or too many differs
    from nothing."""
    texts, lines = made(case).texts, []
    present = {p.name for p in (FOLDER / case).iterdir() if p.is_file()}
    for name in sorted((present | set(texts)) - {"given.py"}):
        before = golden(case, name).splitlines() if name in present else []
        after = texts[name].splitlines() if name in texts else []
        place = f"tests/golden/{case}/{name}"
        lines += difflib.unified_diff(before, after, place, f"{name} as it is made", lineterm="")
        if name not in texts or name not in present:
            lines.append(f"{place}: {'missing' if name in texts else 'no stage writes this file'}")
    return "\n".join(lines)


if __name__ == "__main__":
    print("\n".join(filter(None, map(difference, sys.argv[1:] or CASES))))
