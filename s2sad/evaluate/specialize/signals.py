"""Signals: what ends the evaluation of a piece of text early, and who goes on."""
from __future__ import annotations

from typing import Any

from s2sad.diagnostics import S2sadError
from s2sad.evaluate.specialize.values import Choice, Value
from s2sad.program import Fact
from s2sad.tree import AST


class Unevaluated(Exception):
    """Something must be known before the run that is not: rolled back and tried otherwise, else refused. `demands` are
    the facts about arguments that would make it known, `site` the list that would have to be one at run time, `choice`
    what the slot is called whose values would have to be chosen from; the first round of a loop may differ from the
    others (`differs`); a recursion may have no end (`endless`); `objects` are the places of those that would have to be
    rows of tables."""

    def __init__(self, error: S2sadError, demands: frozenset[Fact] = frozenset(), site: Any = None,
                 differs: bool = False, choice: str = "", endless: bool = False,
                 objects: frozenset[int] = frozenset()):
        super().__init__(str(error))
        self.error, self.demands, self.site, self.differs, self.choice = error, demands, site, differs, choice
        self.endless, self.objects = endless, objects


class Undecided(Exception):
    """An expression gives one of several values, and what is made of it differs: its statement is evaluated for each.
    `since` is how far the evaluation was when the expression began."""

    def __init__(self, node: AST, choice: Choice, since: tuple[int, int]):
        super().__init__(str(node))
        self.node, self.choice, self.since = node, choice, since


class OutsideError(S2sadError):
    """Something of a module is not what a kernel can use: reading has said so, and knows more of it."""


class Unbound(Exception):
    """A name is read in a loop before it is bound there: what an earlier round has bound, if any."""

    def __init__(self, frame: int, name: str, error: S2sadError):
        super().__init__(str(error))
        self.frame, self.name, self.error = frame, name, error


class Reached(Exception):
    """An object from outside is met for the first time on one way, or in a loop: it must be there before."""

    def __init__(self, name: str, value: Any, is_owned: bool):
        super().__init__(name)
        self.name, self.value, self.is_owned = name, value, is_owned


class Raised(Exception):
    """Something is raised whenever the kernel runs, which one of the `handlers` around catches."""

    def __init__(self, handlers: Any, kind: type[BaseException]):
        super().__init__(kind.__name__)
        self.handlers, self.kind = handlers, kind


NOWHERE = -1        # the mark of what nothing follows


class Leave(Exception):
    """`break`, `continue`, `return` in code that is written out, or what nothing follows: `mark` is the place on the
    stack of pending work that it goes to."""

    def __init__(self, mark: int, value: Value | None = None):
        super().__init__(mark)
        self.mark, self.value = mark, value
