"""Pictures in docstrings of passes: a kernel, and what it is after the pass, executed.

    python -m tests.harness.pictures                which passes have none yet
    python -m tests.harness.pictures expand FILE    a picture of the pass for the kernels in the file, to be looked over

A picture is two columns with a `def` at the top of each,

    def f(x, y):                    def f(x, y):
        y[:] = 2.0 * x                  ...
                                        y[...] = 2.0 * x

or, where these would be too wide, two blocks with the word `becomes` in a line of its own between them. On the left is
the kernel as the user writes it; its parameters have the types that `s2sad` assumes, or say so: `x: float32[:]`.
On the right is the tree after the pass. Helpers stand in a block of their own before it. Where the kernel itself is not
the tree before the pass (a derivative is not), it stands in a block of its own, and the picture shows the function, or
the derivative, before and after: `def f_adjoint(...):` for any parameters. `...` is for statements left out; what
assertions say is left out, too; a string that stands alone is a mark that one pass leaves for the next. Of a check the
kernel stands alone, and a line behind it, flush left, says what is refused: `refused: text of the message`.

The kernel is derived under each engine and in each mode, level "fast", with a watch on the passes: one of the trees
that the pass has changed must be that on the right.
"""
from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from s2sad import normalize, optimize, simplify
from s2sad.emit import text
from s2sad.passes import each
from s2sad.tree import Assert, FunctionDef, at, rebuild
from s2sad.units import DERIVATIVES, KERNELS
from s2sad.units.primal_form import PASSES as PRIMAL
from tests.harness.derivation_steps import runs

LISTS = (KERNELS, DERIVATIVES, PRIMAL, normalize.PASSES, simplify.LOWERED, simplify.PASSES,
         optimize.KERNELS, optimize.PASSES)


def functions() -> list[Callable[..., Any]]:
    """The passes of all rooms."""
    return list(dict.fromkeys(step.function for passes in LISTS for step in each(passes)))


def document(function: Callable[..., Any]) -> str:
    """The docstring of a pass: that of its module where they share the name, else its own."""
    module = sys.modules[function.__module__]
    own = module.__name__.rpartition(".")[2] != function.__name__
    return inspect.getdoc(function) or "" if own else inspect.cleandoc(module.__doc__ or "")


# -- what a docstring shows -------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Picture:
    """A kernel; the tree before the pass, if it is shown; the tree after it, or what is refused."""
    kernel: str
    before: str = ""
    after: str = ""
    refused: str = ""


def pictures(doc: str) -> Iterator[Picture]:
    """The pictures of a docstring."""
    parts, kernel = list(_parts(doc)), ""
    while parts:
        words, left, right = parts.pop(0)
        if left and not right and len(parts) > 1 and parts[0][0] == "becomes":
            right = parts[1][1]
            del parts[:2]
        if words.startswith("refused: ") and kernel:
            yield Picture(kernel, refused=words.partition(" ")[2])
            kernel = ""
        elif right and _is_of(left, kernel):
            yield Picture(kernel, left, right)
            kernel = ""
        elif right:
            yield Picture(f"{kernel}\n\n\n{left}" if kernel else left, after=right)
            kernel = ""
        elif left:
            kernel = left


def _is_of(shown: str, kernel: str) -> bool:
    """Whether a text is that of a kernel's function after some passes, or of its derivative."""
    [name] = re.findall(r"^def (\w+)", shown, re.M)[:1]
    return any(name == n or name.startswith(f"{n}_") for n in re.findall(r"^def (\w+)", kernel, re.M))


def _kernels(doc: str) -> bool:
    return any(True for _ in pictures(doc))


def _parts(doc: str) -> Iterator[tuple[str, str, str]]:
    """Lines of words, and blocks with a `def` at their top: one column, or two."""
    lines, position = doc.split("\n"), 0
    while position < len(lines):
        line = lines[position]
        if not line.startswith("    def "):
            if line and not line.startswith(" "):
                yield line.strip(), "", ""
            position += 1
            continue
        middle = line.find("def ", 8)
        end = next((k for k in range(position + 1, len(lines)) if lines[k] and not lines[k].startswith("    ")
                    or middle > 0 and lines[k].startswith("    def ")), len(lines))
        block = [row[4:] for row in lines[position:end]]
        position = end
        if middle < 0:
            yield "", "\n".join(block).strip(), ""
        else:
            columns = [(row[:middle - 4].rstrip(), row[middle - 4:]) for row in block]
            yield "", *("\n".join(column).strip() for column in zip(*columns))


# -- whether they agree -----------------------------------------------------------------------------------------------

def wrong(function: Callable[..., Any], picture: Picture) -> str:
    """What is wrong with a picture of a pass, in words; empty if nothing is."""
    titles = {s.title for passes in LISTS for s in each(passes) if s.function is function}
    derived = runs(picture.kernel)
    if picture.refused:
        said = [r.message for r in derived if r.by is function]
        return "" if any(picture.refused in m for m in said) else "\n".join(
            ["it is not refused so; but:", *(said or [r.message or "accepted" for r in derived])])
    shown = [s for r in derived for s in r.steps if s.title in titles]
    changed = [s for s in shown if s.before is not None and printed(s.before) != printed(s.after)]
    for step in changed:
        if agrees(picture.after, step.after) and (not picture.before or step.before is not None and agrees(
                picture.before, step.before)):
            return ""
    messages = dict.fromkeys(r.message for r in derived if r.message)
    return "\n".join(["it has not been shown so; what the pass has changed:" if changed else
                      f"the pass changes nothing of it, in {len(shown)} trees", *messages,
                      *dict.fromkeys(side_by_side(printed(s.before), printed(s.after)) for s in changed if s.before)])


def printed(function: FunctionDef) -> str:
    """The text of a function, without what its assertions say, and a return of nothing."""
    made = rebuild(function, lambda n: at(Assert(n.test, None), n) if isinstance(n, Assert) else None)
    return text(made, width=None).removesuffix("\n    return")


def agrees(shown: str, made: FunctionDef) -> bool:
    """Whether a text is that of a function, but for what it leaves out."""
    [there] = ast.parse(shown.replace("(...)", "()")).body
    [here] = ast.parse(re.sub(r"^(\s*)# .*$", r"\1pass", printed(made), flags=re.M)).body
    assert isinstance(there, ast.FunctionDef) and isinstance(here, ast.FunctionDef)
    if there.name != here.name:
        return False
    taken = [[a.arg for a in function.args.args] for function in (there, here)]
    body = here.body[1 if ast.get_docstring(here) else 0:]
    return ("(...)" in shown.partition("\n")[0] or taken[0] == taken[1]) and _match(there.body, _plain(body))


def _plain(block: list[ast.stmt]) -> list[ast.stmt]:
    return [s for s in block if not isinstance(s, ast.Pass)]


def _match(shown: list[ast.stmt], made: list[ast.stmt]) -> bool:
    if not shown:
        return not made
    first = shown[0]
    if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and first.value.value is ...:
        return any(_match(shown[1:], made[k:]) for k in range(len(made) + 1))
    return bool(made) and _same(first, made[0]) and _match(shown[1:], made[1:])


def _same(shown: ast.stmt, made: ast.stmt) -> bool:
    if type(shown) is not type(made):
        return False
    for field in shown._fields:
        one, other = getattr(shown, field), getattr(made, field)
        if field in ("body", "orelse"):
            if not _match(_plain(one), _plain(other)):
                return False
        elif field != "type_comment" and _dumped(one) != _dumped(other):
            return False
    return True


def _dumped(value: Any) -> str:
    return ",".join(map(_dumped, value)) if isinstance(value, list) else ast.dump(value) if isinstance(
        value, ast.AST) else repr(value)


# -- the command ------------------------------------------------------------------------------------------------------

def side_by_side(left: str, right: str) -> str:
    """Two texts beside each other, as a docstring shows them."""
    rows, others = left.split("\n"), right.split("\n")
    wide = max(map(len, rows)) + 4
    wide += -(wide + 4) % 4
    if wide + max(map(len, others)) > 112:
        return "\n".join(["", *(f"    {r}" for r in rows), "becomes", "", *(f"    {r}" for r in others)])
    rows += [""] * (len(others) - len(rows))
    others += [""] * (len(rows) - len(others))
    return "\n".join(f"    {r:{wide}}{o}".rstrip() for r, o in zip(rows, others))


def main() -> int:
    named = {f.__name__: f for f in functions()}
    if len(sys.argv) < 3:
        for name, function in named.items():
            if not _kernels(document(function)):
                print(f"{function.__module__}: {name}")
        return 0
    function, kernel = named[sys.argv[1]], Path(sys.argv[2]).read_text(encoding="utf-8").strip()
    print(wrong(function, Picture(kernel, after="def _():\n    pass")))
    return 0


if __name__ == "__main__":
    sys.exit(main())
