"""checked_primal: the primal compiled with bounds checks, which runs before what might leave its arrays."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from s2sad.dispatch.executable import Executable
from s2sad.run.compiled import compiled, prepare, quiet
from s2sad.run.compiler_lock import COMPILER_LOCK
from s2sad.run.exceptions import CAUGHT
from s2sad.run.line_marks import with_line_marks
from s2sad.run.module_loader import keep_loaded

Arguments = Callable[[], list[Any]]


class CheckedPrimal:
    """That of a `variant` which is the primal, for one set of types; `calls_users` if it calls functions of theirs."""

    def __init__(self, variant: Executable, calls_users: bool):
        self.variant, self._calls_users = variant, calls_users
        self._functions: dict[bool, Callable[..., Any]] = {}

    def __call__(self, arguments: Arguments) -> None:
        """Runs it on `arguments()`, which it may write; raises IndexError with the line of the kernel."""
        given = arguments()
        function = self._compiled(given)
        try:
            function(*given)
        except CAUGHT as error:
            raise self.variant.failures.meaning(error) from None
        except IndexError as error:
            raise self.variant.failures.of_index(error, self._line(arguments)) from None

    def _line(self, arguments: Arguments) -> int:
        """The line of the text in which an index is out of bounds."""
        line = np.zeros(1, np.int64)
        given = [*arguments(), line]
        with suppress(IndexError):
            self._compiled(given, lines=True)(*given)
        return int(line[0])

    def _compiled(self, arguments: Sequence[Any], lines: bool = False) -> Callable[..., Any]:
        """The function; with `lines` one that says where it is."""
        with COMPILER_LOCK:
            if lines not in self._functions:
                generated = self.variant.generated
                text, guards = quiet(generated.text), tuple(generated.facts.get("guards", ()))
                module = compiled(with_line_marks(text) if lines else text, generated.entry, bounds=True,
                                  user_functions=self._calls_users, guards=() if lines else guards,
                                  entries=[generated.entry])
                keep_loaded(module, self)
                function = getattr(module, generated.entry)
                prepare(function, arguments, f"'{self.variant.kernel}'")
                self._functions[lines] = function
            return self._functions[lines]
