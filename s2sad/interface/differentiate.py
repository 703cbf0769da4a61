"""The decorator, and Enzyme's call: derivatives with shadows that the caller owns."""
from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Concatenate, Generic, NoReturn, ParamSpec, TypeVar, overload

from s2sad.interface.autodiff import AnnotatedCall
from s2sad.interface.activities import Annotation, BatchDuplicated, Const, Duplicated, Mode
from s2sad.interface.batch_autodiff import batch_call
from s2sad.dispatch.arguments import kernel_value, bind, describe
from s2sad.dispatch.deferred import compiler
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.interface.bound_derivatives import Adjoint, AugmentedPrimal
from s2sad.interface.recording_arguments import Checkpoint, recording_of
from s2sad.interface.foreign_names import unexpected_keywords
from s2sad.interface.pytrees import flat_autodiff as with_structures, flat_tapes, flatten, flat_call
from s2sad.interface.pickling import Decorated
from s2sad.interface.value_calls import selection_of
from s2sad.program import Economy, Recording, Request, TapeDtype
from s2sad.live_objects.unwrap import apply_functions
from s2sad.run.compiled import chosen
from s2sad.run.memory import Memory
from s2sad.interface.selection import (
    ReturnedValues, Selection, Wrt, names_of, selected_of, selected_wrt,
)
from s2sad.interface.shadow_calls import ShadowCall
from s2sad.interface.shadow_signature import argument_text
from s2sad.interface.split_calls import split_call
from s2sad.interface.tapes import Tape
from s2sad.pytree import is_structure
from s2sad.run.tracebacks import public, shortened
from s2sad.dispatch.cache import ProgramVersion, derivatives_of

__all__ = ["Differentiated", "autodiff", "differentiate"]


P = ParamSpec("P")
Q = ParamSpec("Q")
R = TypeVar("R", covariant=True)


@overload
def differentiate(function: Callable[P, R], *, wrt: Wrt = None, of: Wrt = None, engine: str = "auto",
                  checkpoint: Checkpoint = None, memory: Economy | None = None,
                  tape_dtype: TapeDtype | None = None) -> Differentiated[P, R]: ...


@overload
def differentiate(function: None = None, *, wrt: Wrt = None, of: Wrt = None, engine: str = "auto",
                  checkpoint: Checkpoint = None, memory: Economy | None = None, tape_dtype: TapeDtype | None = None
                  ) -> Callable[[Callable[P, R]], Differentiated[P, R]]: ...


@public
def differentiate(function: Callable[..., Any] | None = None, *, wrt: Wrt = None, of: Wrt = None,
                  engine: str = "auto", checkpoint: Checkpoint = None, memory: Economy | None = None,
                  tape_dtype: TapeDtype | None = None, **unknown: NoReturn) -> Any:
    """The function, which still does what it did, with its derivatives as attributes; see `Differentiated`.

    Args: wrt, names or positions of parameters (default: every float array and float scalar); of, names of written
    arrays and "return" (default: all of them); engine, "auto" (Numba where it is installed), "numba" or "numpy";
    checkpoint, the loops that keep snapshots in place of a tape, and how many: {"k": 20}, {"advance.k": 20} of a
    function that is called, {"line 14": 20}; or the memory that a call may take beside its arguments, "1 GB" or a
    number of bytes, within which loops and numbers are chosen by the sizes of each call (S410 where none fits); memory,
    what counts where memory costs time: "least", "balanced" (default) or "fastest"; tape_dtype, "float64" (default), or
    "float32" where floats of double precision are to be recorded in single precision, rounded by 6e-8 of themselves.
    Raises S2sadError (S405) for an engine that is not there, S408 for a `checkpoint` that is none; everything else when
    a derivative is first asked for. Literature: Griewank and Walther, ACM TOMS 26, 2000.

    >>> @differentiate(wrt="u", engine="numpy")
    ... def double(u):
    ...     for i in range(u.size):
    ...         u[i] *= 2.0
    >>> double
    <differentiated double>
    """
    if unknown:
        raise unexpected_keywords("differentiate", unknown)
    chosen(engine)
    if function is None:
        recording = recording_of(checkpoint, memory, tape_dtype)
        return lambda f: Differentiated(f, wrt, of, engine, recording)
    return Differentiated(function, wrt, of, engine, recording_of(checkpoint, memory, tape_dtype))


class Differentiated(Decorated, Generic[P, R]):
    """A function with its derivatives; calling it calls the original, untouched.

    Shadows follow one law: on entry a shadow holds the adjoint of its array's exit value, on exit that of its entry
    value. After `adjoint` and `tangent` what a written argument holds is unspecified, and so is every content when the
    function raises midway.
    """

    def __init__(self, function: Callable[P, R], wrt: Wrt = None, of: Wrt = None, engine: str = "auto",
                 checkpoint: Checkpoint = None):
        self.__wrapped_kernel__ = derivatives_of(function).function
        functools.update_wrapper(self, self.__wrapped_kernel__, updated=())
        self._original = function
        self._derivatives = derivatives_of(function)
        self.wrt, self.of = names_of(wrt, function), names_of(of, function, "of")
        self.__s2sad_selection__ = Selection(self.wrt, self.of, engine, recording_of(checkpoint))
        self._tokens = {mode: f"{mode} {self.__s2sad_selection__!r}" for mode in ("adjoint", "tangent")}

    def decorator_arguments(self) -> tuple[Any, ...]:
        return self._original, *self.__s2sad_selection__

    @property
    def engine(self) -> str:
        """The engine that runs the derivatives: "numba" or "numpy"."""
        return chosen(self.__s2sad_selection__.engine)

    def __call__(self, *args: P.args, **keywords: P.kwargs) -> R:
        return self._original(*args, **keywords)

    @overload
    def __get__(self, instance: None, owner: Any = None) -> Differentiated[P, R]: ...

    @overload
    def __get__(self: Differentiated[Concatenate[Any, Q], R], instance: object, owner: Any = None
                ) -> Callable[Q, R]: ...

    def __get__(self, instance: Any, owner: Any = None) -> Any:
        return self if instance is None else functools.partial(self, instance)

    def __repr__(self) -> str:
        return f"<differentiated {self.__wrapped_kernel__.__name__}>"

    @property
    def adjoint(self) -> Adjoint:
        """The adjoint of f, a function of f's arguments with their shadows: see `Adjoint`."""
        return Adjoint(self)

    def tangent(self, *args: Any) -> Any:
        """The tangents of the float results; those of written arrays stand in their shadows.

        Args: f's arguments, each followed by its tangent if it has one. Raises as `adjoint` does.
        """
        try:
            return self._shadowed("tangent", args)
        except Exception as error:
            outside = shortened(error)
        raise outside

    @property
    def augmented(self) -> AugmentedPrimal:
        """What runs f and returns a tape beside its result: see `AugmentedPrimal`."""
        return AugmentedPrimal(self)

    @public
    def reverse(self, tape: Tape, *shadows: Any, keep: bool = False) -> Any:
        """The adjoints of the float scalar arguments as a tuple, in order (None without any); shadows in place.

        Args: tape, of this function's `augmented`; shadows, those that `adjoint` takes, in its order, then the seeds of
        the float results; keep, whether the tape stays for another sweep, which costs copies of what the sweep writes
        in it. Raises S2sadError, before anything is written: S403, S404, S405 as `adjoint`, S409 (a tape that was used
        up, freed, or is of another function).
        """
        if not isinstance(tape, Tape):
            title = self.__wrapped_kernel__.__name__
            raise S2sadError(Diagnostic("S409", f"'{title}.reverse' was given {argument_text(tape)} in place of a tape",
                                        help=f"result, tape = {title}.augmented(...)"))
        return tape.reverse(self, shadows, keep)

    @public
    def primal(self, *args: Any, **keywords: Any) -> Any:
        """What f returns, computed by the compiled primal (under NumPy: by f itself)."""
        given, args, keywords = apply_functions(self, args, keywords)
        if given is not self:
            return Differentiated(given, engine=self.engine).primal(*args, **keywords)
        state = self._derivatives.state()
        structures = flatten(state, bind(state.kernel, args, keywords))
        if structures is not None:
            if self.engine == "numpy":
                return self.__wrapped_kernel__(*args, **keywords)
            return with_structures.primal(structures, bind(state.kernel, args, keywords), self.engine)
        values = self._values(state, args, keywords)
        types = state.types(values)
        function, check = state.primal(types, self.engine), state.overlap_check(types)
        if check is not None:
            check(values)
        state.check_bounds(values, self.engine)
        results = ReturnedValues.of(state.summary(types))
        return results.with_aliases(function(*values), dict(zip(state.parameters, values)))

    @public
    def adjoint_source(self, *args: Any, level: str = "plain", split: bool = False, **keywords: Any) -> str:
        """The generated adjoint module's text for arguments of these types (f's own, without shadows); `split`, as
        `augmented` and `reverse` run it."""
        return self._source("adjoint", args, keywords, level, split)

    @public
    def tangent_source(self, *args: Any, level: str = "plain", **keywords: Any) -> str:
        """The generated tangent module's text for arguments of these types (f's own, without shadows)."""
        return self._source("tangent", args, keywords, level)

    @public
    def compiled(self, mode: str, *args: Any) -> Callable[..., Any]:
        """The bare function for arguments of these types, compiled: no checks, no conversions, no overhead.

        The arrays that it is given share no memory, shadows and seeds among them.

        Args: mode, "adjoint", "tangent" (args as for these) or "primal" (f's own arguments). Arrays that f reads from
        its module are its last parameters; numbers from there are those of now.
        """
        state = self._derivatives.with_constants()
        if any(map(is_structure, args)):
            raise S2sadError(Diagnostic("S405", f"'{self.__wrapped_kernel__.__name__}.compiled' was given a structure",
                                        help="the bare function takes arrays and numbers: call adjoint or tangent"))
        if mode in ("adjoint", "tangent"):
            return ShadowCall(state, mode, args, self.__s2sad_selection__, bare=True).function(args)
        if mode != "primal":
            raise S2sadError(Diagnostic("S405", f"there is no mode {mode!r}", help='"adjoint", "tangent" or "primal"'))
        values = self._values(state, args, {})
        if self.engine == "numpy":
            return self.__wrapped_kernel__
        variant = state.variant(Request("primal", state.types(values), (), ()), self.engine)
        variant.prepare(variant.assemble(dict(zip(state.parameters, values)), {}, (), state.arrays_by_name()))
        return variant.function

    def _shadowed(self, mode: str, args: tuple[Any, ...]) -> Any:
        state = self._derivatives.state()
        key = (self._tokens[mode], describe(args))
        entry = state.entries.get(key)
        if entry is None:
            found = with_structures.shadowed(state, mode, args, self)
            if found is not None:
                return found[0]
            entry = state.entries[key] = ShadowCall(state, mode, args, self.__s2sad_selection__)
        return entry(args)

    def _values(self, state: ProgramVersion, args: tuple[Any, ...], keywords: dict[str, Any]) -> list[Any]:
        bound = bind(state.kernel, args, keywords)
        return [kernel_value(n, v, n in state.floats) for n, v in zip(state.parameters, bound)]

    def _source(self, mode: str, args: tuple[Any, ...], keywords: dict[str, Any], level: str,
                split: bool = False) -> str:
        given, args, keywords = apply_functions(self, args, keywords)
        derivatives = self._derivatives if given is self else derivatives_of(given)
        state, values, request = self._request(derivatives.with_constants(), mode, args, keywords)
        limited = state.variant(request, self.engine).limited if request.recording.limit else None
        if limited is not None:
            plan = limited.plan({**values, **state.arrays_by_name()}, 0)
            request = replace(request, recording=request.recording.keeping(plan.checkpoints))
        request = replace(request, engine=self.engine, level=level, split=split)
        return compiler().derived(state.program, request, {}).text

    def _request(self, state: ProgramVersion, mode: str, args: tuple[Any, ...], keywords: dict[str, Any]
                 ) -> tuple[ProgramVersion, dict[str, Any], Request]:
        """The derivative that f's own arguments ask for, and these by name, flat where they are structures."""
        state, values, carried = flat_call(state, self, args, keywords)
        values = [kernel_value(n, v, n in state.floats) for n, v in zip(state.parameters, values)]
        types, name, parameters = state.types(values), state.kernel.name, state.parameters
        wrt = selected_wrt(name, parameters, types, carried.wrt)
        of = selected_of(name, parameters, types, state.summary(types), carried.of)
        recording = carried.recording if mode == "adjoint" else Recording()
        return state, dict(zip(parameters, values)), Request(mode, types, wrt, of, recording=recording)

    def _run_augmented(self, args: tuple[Any, ...], keywords: dict[str, Any]) -> tuple[Any, Tape]:
        given, args, keywords = apply_functions(self, args, keywords)
        state = (self._derivatives if given is self else derivatives_of(given)).state()
        values = bind(state.kernel, args, keywords)
        flattened = flatten(state, values)
        found = (split_call(state, values, self.__s2sad_selection__).augmented(values) if flattened is None else
                 flat_tapes.augmented(flattened, values, self))
        return found.result, Tape(self, found.variant, found.entries, found.sweep)

    def _memory(self, args: tuple[Any, ...], keywords: dict[str, Any], split: bool = False) -> Memory:
        given, args, keywords = apply_functions(self, args, keywords)
        derivatives = self._derivatives if given is self else derivatives_of(given)
        state, values, request = self._request(derivatives.state(), "adjoint", args, keywords)
        request = replace(request, split=split)
        return state.variant(request, self.engine).memory({**values, **state.arrays_by_name()})


@public
def autodiff(mode: Mode, f: Callable[..., Any], *annotated: Any, seed: Any = None) -> Any:
    """Enzyme's call: in reverse a tuple with one derivative for each `Active` argument, forwards the tangent of the
    returned value; with primal, (that, what f returns).

    Args: mode, `Forward`, `ForwardWithPrimal`, `Reverse` or `ReverseWithPrimal`; annotated, f's arguments, floats and
    arrays as `Const(x)`, `Active(x)` (a float, in reverse), `Duplicated(x, shadow)` or `DuplicatedNoNeed(x, shadow)`
    with shadows of the same shape and dtype, everything else as it is or `Const`; seed, the adjoint of the returned
    value: 1.0 by default if that is a float, required with the same structure if it is an array or a tuple (None
    where that holds no float). `BatchDuplicated(x, (d1, d2, ...))` gives several directions, which all arguments with
    shadows have then: forwards comes a tuple with a tangent for each, in reverse a tuple with a derivative for each in
    place of that of an `Active` argument, and seed is a tuple with one for each. Shadows lie apart.
    Raises S2sadError before anything is written: S402 (an annotation missing or out of place), S403, S404, S405, S406
    (an active value stored in a `Const` array); and what f raises, after which all contents are unspecified.
    Literature: Moses and Churavy, Instead of Rewriting Foreign Code for Machine Learning, NeurIPS 2020.

    >>> import s2sad
    >>> from s2sad import Active, Reverse
    >>> def square(x):
    ...     return x * x
    >>> autodiff(Reverse, square, Active(3.0))
    (6.0,)
    >>> autodiff(s2sad.Forward, square, s2sad.BatchDuplicated(3.0, (1.0, 0.5)))
    (6.0, 3.0)
    """
    if not isinstance(mode, Mode):
        raise S2sadError(Diagnostic("S402", f"{mode!r} is no mode",
                                    help="use Forward, ForwardWithPrimal, Reverse or ReverseWithPrimal"))
    given, annotated, _ = apply_functions(f, [
        a.value if isinstance(a, Const) and callable(a.value) else a for a in annotated], {})
    state = derivatives_of(given).state()
    if any(isinstance(a, BatchDuplicated) for a in annotated):
        return batch_call(state, mode, annotated, selection_of(f), seed)
    found = with_structures.flat_autodiff(state, mode, annotated, selection_of(f), seed)
    if found is not None:
        return found[0]
    selection = selection_of(f)
    kinds = tuple([type(a) if isinstance(a, Annotation) else None for a in annotated])
    values = [a.value if isinstance(a, Annotation) else a for a in annotated]
    shadows = [a.shadow for a in annotated if isinstance(a, Duplicated)]
    key = (mode, selection.engine, selection.recording, kinds, describe(values), describe(shadows))
    entry = state.entries.get(key)
    if entry is None:
        entry = state.entries[key] = AnnotatedCall(state, mode, annotated, selection)
    return entry(values, shadows, seed)
