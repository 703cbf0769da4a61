"""The tape of one call of `f.augmented`, which `f.reverse` takes."""
from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.cache import derivatives_of
from s2sad.dispatch.split_executable import SplitExecutable, arrays_in
from s2sad.dispatch.memory_reuse import clear_kept
from s2sad.interface.pickling import Decorated
from s2sad.run.tracebacks import public


@public
def clear(f: Any = None) -> int:
    """Frees the tapes of compiled adjoints, and the copies of arguments and seeds, that calls keep for the next, those
    of f or of all functions, in all threads; the bytes that they took.

    Args: f, a function, a differentiated one, or what `gradient` and `value_and_gradient` return. Tapes of running
    calls stay, and are kept when these end. What is kept takes at most $S2SAD_TAPE_SIZE (default 1G).

    >>> def square(u):
    ...     u[:] = u * u
    >>> clear(square)
    0
    """
    if f is None:
        return clear_kept()
    return clear_kept(derivatives_of(f.__wrapped__ if isinstance(f, Decorated) else f).function)


class Tape:
    """What the forward sweep of one call keeps for reverse sweeps: all that these read, in memory of its own. Arguments
    and results may be written as soon as it is there.

    One reverse sweep uses it up, unless that is asked to keep it. Its memory is given back then, by `free()`, at the
    end of a `with` block, or with the last reference. `nbytes` are the bytes of its arrays.
    """

    def __init__(self, function: Any, variant: SplitExecutable, entries: tuple[Any, ...], sweep: Callable[..., Any]):
        self._function, self._variant, self._sweep = function, variant, sweep
        self._entries: tuple[Any, ...] | None = entries
        self._spent = ""
        self._lock = threading.Lock()

    @property
    def name(self) -> str:
        """The name of the function that was run."""
        return self._function.__wrapped_kernel__.__name__

    @property
    def nbytes(self) -> int:
        """The bytes of the arrays that it holds; 0 if it was used up or freed."""
        return sum({id(a): a.nbytes for a in arrays_in(self._entries or ())}.values())

    def free(self) -> None:
        """Gives its memory back; a tape that was used up or freed stays so."""
        with self._lock:
            self._entries, self._spent = None, self._spent or "was freed"

    def reverse(self, function: Any, given: Sequence[Any], keep: bool) -> Any:
        """The reverse sweep over it; raises S2sadError (S409) if it is not `function` that was run."""
        ours, theirs = self._function.decorator_arguments(), function.decorator_arguments()
        if self._function is not function and ours != theirs:
            title = function.__wrapped_kernel__.__name__
            what = f"'{self.name}'" if self.name != title else "one with another wrt, of, engine, checkpoint or memory"
            raise S2sadError(Diagnostic("S409", f"'{title}.reverse' was given a tape of {what}",
                                        help=f"give what {title}.augmented returned beside the result"))
        self.entries()
        return self._sweep(self, given, keep)

    def take(self, keep: bool) -> tuple[Any, ...]:
        """What a reverse sweep gets: the tape, or one that it may write while this one stays what it is."""
        with self._lock:
            if self._entries is None:
                raise self._refused()
            entries = self._variant.intact(self._entries) if keep else self._entries
            if not keep:
                self._entries, self._spent = None, "was used up by a reverse sweep"
            return entries

    def entries(self) -> tuple[Any, ...]:
        """What it holds; raises S2sadError (S409) if it was used up or freed."""
        if self._entries is None:
            raise self._refused()
        return self._entries

    def _refused(self) -> S2sadError:
        again = f"call {self.name}.augmented again"
        used = self._spent != "was freed"
        return S2sadError(Diagnostic("S409", f"the tape of '{self.name}' {self._spent}", help=(
            f"say keep=True in each sweep but the last, or {again}" if used else again)))

    def __enter__(self) -> Tape:
        return self

    def __exit__(self, *error: object) -> None:
        self.free()

    def __reduce__(self) -> NoReturn:
        raise S2sadError(Diagnostic("S409", f"the tape of '{self.name}' cannot be copied or pickled",
                                    help=f"call {self.name}.augmented where the reverse sweep is to run"))

    def __repr__(self) -> str:
        return f"<tape of {self.name}, {f'{self.nbytes:,} bytes' if self._entries is not None else self._spent}>"
