"""The constructs of texts for Numba, and the cases of tests/corpus/compiled.txt, which Numba compiles so that each is.

A construct is a form of a statement, an operator with the types of its operands, a subscript with those of its indices,
or a function with those of its arguments, as they are when Python runs the text. What the compiler emits in any case is
compiled in one at least: `python -m tests.harness.constructs` runs all cases and chooses anew, `python -m
tests.harness.constructs tests/test_corpus.py -k lists` only among those, and leaves the others as they stand. Cases are
those of tests/corpus and of other tests that take their engines from harness/engines.py.
"""
from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

LIST = Path(__file__).resolve().parents[1] / "corpus" / "compiled.txt"
HEAD = "# What Numba compiles, by case, with the constructs that it is chosen for: python -m tests.harness.constructs\n"

_BUILTINS = {"a function of the module", "abs", "bool", "float", "int", "len", "max", "min", "range"}


@cache
def listed() -> dict[str, frozenset[str]]:
    """The cases that Numba compiles, each with what it is chosen for."""
    found: dict[str, set[str]] = {}
    for line in LIST.read_text().splitlines() if LIST.exists() else ():
        if line.startswith("    "):
            found[next(reversed(found))].add(line.strip())
        elif line and not line.startswith("#"):
            found[line] = set()
    return {case: frozenset(constructs) for case, constructs in found.items()}


@cache
def _compiled() -> frozenset[str]:
    return frozenset().union(*listed().values())


def check(case: str, found: set[str]) -> None:
    """What a case emits is compiled somewhere, and the case is what it was chosen for."""
    unheard = sorted(found - _compiled())
    gone = sorted(listed().get(case, frozenset()) - found)
    assert not unheard and not gone, (
        f"{case} emits what no case of tests/corpus/compiled.txt does: {unheard}; listed there for it, and not "
        f"emitted: {gone}; write the list anew: python -m tests.harness.constructs")


def write(folder: str, case: str, found: set[str]) -> None:
    """Adds what a case emits to this process's file."""
    with Path(folder, f"{os.getpid()}.json").open("a") as file:
        file.write(json.dumps([case, sorted(found)]) + "\n")


def read(folder: str) -> dict[str, set[str]]:
    """What was written there, by case."""
    emitted: dict[str, set[str]] = {}
    for path in Path(folder).glob("*.json"):
        for line in path.read_text().splitlines():
            case, constructs = json.loads(line)
            emitted.setdefault(case, set()).update(constructs)
    return emitted


def seconds(constructs: set[str]) -> float:
    """How long Numba takes for a case that emits these, roughly: of linear algebra and functions of the runtime there
    is most to compile, next to nothing of the text itself."""
    found = 0.5
    for construct in constructs:
        called, _, _ = construct.partition("(")
        if construct.startswith("matmul "):
            found += 1.0
        elif called != construct and " " not in called and called not in _BUILTINS:
            found += 0.25 if called.startswith(("np.", "math.")) else 5.0 if called.startswith(".") else 1.0
    return found


def chosen(emitted: dict[str, set[str]], kept: dict[str, frozenset[str]]) -> dict[str, set[str]]:
    """Cases that together emit everything, most constructs for their time first, none of which the others make
    superfluous; `kept` are chosen already."""
    found = {case: set(constructs) for case, constructs in kept.items()}
    left = wanted = set().union(*emitted.values()) - set().union(*found.values())
    cost = {case: seconds(constructs) for case, constructs in emitted.items()}
    made: list[str] = []
    while left:
        made.append(max(sorted(emitted), key=lambda c: len(emitted[c] & left) / cost[c]))
        left = left - emitted[made[-1]]
    for case in sorted(made, key=lambda c: -cost[c]):
        others = [c for c in made if c != case]
        if wanted <= set().union(*(emitted[c] for c in others)):
            made = others
    for case in made:
        found[case] = emitted[case] & wanted
        wanted = wanted - emitted[case]
    return found


def write_list(found: dict[str, set[str]]) -> None:
    """Writes tests/corpus/compiled.txt."""
    lines = [HEAD, *(f"{case}\n" + "".join(f"    {c}\n" for c in sorted(found[case])) for case in sorted(found))]
    LIST.write_text("".join(lines))


def main(arguments: list[str]) -> int:
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "pytest", "-q", "-m", "emits", "--constructs", folder]
        done = subprocess.run([*command, *(arguments or ["tests"])], check=False)
        emitted = read(folder)
    kept = {case: c for case, c in listed().items() if case not in emitted} if arguments else {}
    found = chosen(emitted, kept)
    listed_now = set().union(*found.values())
    lost = sorted(_compiled() - listed_now) if arguments else []
    write_list(found)
    print(f"{len(emitted)} cases, {len(found)} of them compiled for {len(listed_now)} constructs")
    if lost:
        print(f"listed for none of the cases that ran any more: {lost}; if others emit them, run these, too")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
