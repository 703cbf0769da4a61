"""line_table: the guards of a generated text by their lines, and the places of all its other lines.

    assert u.shape == v.shape, "shapes differ: ..."     line 12: u += v in the kernel, what is said, what is compared

The kernel's own assertions are none: their messages are marked where they are read
(`normalize/control/single_target.py`), and an assertion without a message is the kernel's.
"""
from __future__ import annotations

import re
from collections.abc import Sequence


from s2sad.diagnostics import Source
from s2sad.emit.module import ModuleText
from s2sad.normalize.shape_guards import INSIDE
from s2sad.program import MISFIT, TextGuard, SourcePlace
from s2sad.tree import SAID, Assert, Compare, Constant, Raise, written


_ROOM = re.compile(r"\b(builtins|runtime)\.")


def line_table(printed: ModuleText, sources: Sequence[Source]) -> tuple[dict[int, TextGuard], dict[int, SourcePlace]]:
    """The guards and, but for what the kernel raises, the places by line, from 1; `sources` are those of the functions,
    in order."""
    guards: dict[int, TextGuard] = {}
    places: dict[int, SourcePlace] = {}
    for function, source in zip(printed.functions, sources):
        for line, statement in enumerate(function.statements, function.first + 1):
            place = SourcePlace.of(source, statement) if getattr(statement, "lineno", None) else None
            if isinstance(statement, Assert) and _is_guard(statement):
                guards[line] = _guard(statement, place)
            elif place is not None and not isinstance(statement, Raise):
                places[line] = place
    return guards, places


def _is_guard(statement: Assert) -> bool:
    message = statement.msg
    return isinstance(message, Constant) and isinstance(message.value, str) and message.kind != SAID


def _guard(statement: Assert, place: SourcePlace | None) -> TextGuard:
    said, test = statement.msg.value, statement.test
    compared = isinstance(test, Compare) and len(test.ops) == 1
    texts = tuple(_ROOM.sub("", written(side)) for side in (test.left, test.comparators[0])) if compared else ()
    if said.endswith(MISFIT):
        return TextGuard(said, "", place, texts, said.removesuffix(MISFIT))
    message, _, help = said.partition(": ")
    return TextGuard(message, help.partition(": ")[0] if said.startswith(INSIDE) else help, place, texts)
