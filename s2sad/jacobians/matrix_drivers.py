"""What `Jacobian` and `Hessian` share: a function of f's arguments that returns a matrix, dense or by a plan."""
from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.arguments import bind, kernel_value
from s2sad.dispatch.cache import DerivativeCache, ProgramVersion, derivatives_of
from s2sad.infer.types import Type
from s2sad.interface.pickling import Decorated
from s2sad.interface.pytrees import Flattened, flatten
from s2sad.interface.value_calls import selection_of
from s2sad.jacobians.batch_widths import MeasuredWidths
from s2sad.jacobians.coloring import starts_of
from s2sad.jacobians.compression_plan import Plan, PlanMode, Widths, scipy_sparse
from s2sad.jacobians.linear_maps import LinearMap, dense, size
from s2sad.jacobians.sparsity import pattern_of
from s2sad.live_objects.unwrap import apply_functions
from s2sad.run.tracebacks import public

FORMATS = ("csr", "csc", "coo")


class MatrixDriver(Decorated):
    """A function of f's arguments that returns the matrix of a linear map at them; `_what` it gives.

    One plan is kept for each pair of shapes, and one choice of widths. What a matrix gives for one more direction is
    compared with the linear map itself at each call (`check`): where data have changed the pattern, it is found anew;
    one of the user's is refused.
    """
    _what = ""

    def __init__(self, f: Any, mode: PlanMode, sparse: Any, format: str, check: bool, threads: int):
        if format not in FORMATS:
            raise S2sadError(Diagnostic("S405", f"there is no format {format!r}", help='"csr", "csc" or "coo"'))
        if isinstance(threads, bool) or not isinstance(threads, int) or threads < 1:
            raise S2sadError(Diagnostic("S405", f"there are no {threads!r} threads", help="give how many: 1, 2, ..."))
        self.__wrapped__, self._sparse, self._format, self._check, self._threads = f, sparse, format, check, threads
        self._mode: PlanMode = mode
        self._plans: dict[tuple[Any, ...], Plan] = {}
        self._widths: dict[tuple[Any, ...], MeasuredWidths] = {}
        self._given = sparse if isinstance(sparse, Plan) else None
        name, self.__module__ = getattr(f, "__name__", "f"), getattr(f, "__module__", __name__)
        self.__name__ = self.__qualname__ = f"{self._what}_of_{name}"
        self.__doc__ = f"The {self._what} of '{name}'."

    def __repr__(self) -> str:
        return f"<{self._what} of {getattr(self.__wrapped__, '__name__', 'f')}>"

    @abstractmethod
    def linear_map(self, call: FlatCall) -> LinearMap:
        """The linear map at these arguments."""

    @cached_property
    def _derivatives(self) -> DerivativeCache:
        return derivatives_of(self.__wrapped__)

    @public
    def plan(self, *args: Any, **keywords: Any) -> Plan:
        """The plan of the sparse matrix for arguments of these shapes, with the widths that are fastest: see `Plan`."""
        call = FlatCall.of(self.__wrapped__, args, keywords, self._derivatives)
        with call.user_paths():
            of = self.linear_map(call)
            plan = self._plan(of)
            made = plan.measured(self._widths_for(of).measure(
                lambda widths: plan.entries(of, self._check, widths, self._threads), lambda: self._choices(of, plan)))
            self._plans[of.taken, of.given] = made
            return made

    @public
    def __call__(self, *args: Any, **keywords: Any) -> Any:
        call = FlatCall.of(self.__wrapped__, args, keywords, self._derivatives)
        with call.user_paths():
            return self._found(self.linear_map(call))

    def _found(self, of: LinearMap) -> Any:
        """What a call gives."""
        return self._matrix(of)

    def _matrix(self, of: LinearMap) -> Any:
        if self._sparse is False:
            by_rows = self._mode == "reverse" or self._mode == "auto" and size(of.taken) > 2 * size(of.given)
            mode, count = ("reverse", size(of.given)) if by_rows else ("forward", size(of.taken))
            return self._widths_for(of).make(
                lambda widths: dense(of, mode, widths[by_rows], self._threads),
                lambda: {by_rows: of.widths(count, by_rows)}).reshape(of.given + of.taken)
        key = (of.taken, of.given)
        plan = self._given or self._plans.get(key) or self._plan(of)
        plan.check_shapes(of)
        entries, theirs = self._entries(of, plan)
        if self._check and not plan.agrees(of, entries, theirs):
            plan, entries = self._again(of, plan, entries, theirs)
        self._plans[key] = plan
        return plan.matrix(entries, self._format)

    def _entries(self, of: LinearMap, plan: Plan) -> tuple[np.ndarray, np.ndarray]:
        """The entries, and what the check compares them with."""
        def made(widths: Widths) -> tuple[np.ndarray, np.ndarray]:
            return plan.entries(of, self._check, widths, self._threads)
        if any(plan.widths):
            return made(plan.widths)
        return self._widths_for(of).make(made, lambda: self._choices(of, plan))

    def _widths_for(self, of: LinearMap) -> MeasuredWidths:
        return self._widths.setdefault((of.taken, of.given), MeasuredWidths())

    def _choices(self, of: LinearMap, plan: Plan) -> dict[bool, Sequence[int]]:
        """The widths to be tried for a plan."""
        first = plan.told[0]
        return {told.transposed: of.widths(told.colors + (self._check and told is first), told.transposed)
                for told in plan.told}

    def _again(self, of: LinearMap, plan: Plan, entries: np.ndarray, theirs: np.ndarray) -> tuple[Plan, np.ndarray]:
        """The plan and the entries where the check failed: data have changed, or it has seen rounding errors."""
        found = pattern_of(of)
        if not plan.holds(*found) and self._given is None and self._sparse is True:
            plan = Plan.of(*found, of, self._mode)
            entries, theirs = self._entries(of, plan)
        if not plan.holds(*found) or not plan.agrees(of, entries, theirs, rounded=True):
            raise S2sadError(Diagnostic(
                "S403", f"the pattern of the {self._what} of '{self.__wrapped__.__name__}' lacks entries: for one "
                "more direction the matrix gives something else than the derivative",
                help="give a pattern with all entries that can be other than zero, or sparse=True, which finds it"))
        return plan, entries

    def _plan(self, of: LinearMap) -> Plan:
        return Plan.of(*(pattern_of(of) if isinstance(self._sparse, (bool, Plan)) else self._users(of)), of, self._mode)

    def _users(self, of: LinearMap) -> tuple[np.ndarray, np.ndarray]:
        """The pattern that the user has given, a sparse matrix or a dense one, by rows."""
        pattern = scipy_sparse().coo_array(self._sparse)
        if pattern.shape != (size(of.given), size(of.taken)):
            raise S2sadError(Diagnostic("S405", f"the pattern is of shape {pattern.shape}, the matrix of shape "
                                        f"{(size(of.given), size(of.taken))}", help="give one of that shape"))
        found = np.unique(np.stack([pattern.row, pattern.col]), axis=1)
        return starts_of(found[0], pattern.shape[0]), found[1]


@dataclass(frozen=True)
class FlatCall:
    """A call of f: the program and its arguments by position, of arrays and numbers, and what f carries; `structures`
    leads back to the caller's where some were."""
    state: ProgramVersion
    args: Sequence[Any]
    carrier: Any
    structures: Flattened | None
    given: Sequence[Any]

    @classmethod
    def of(cls, f: Any, args: Sequence[Any], keywords: dict[str, Any], derivatives: DerivativeCache | None = None
           ) -> FlatCall:
        given, args, keywords = apply_functions(f, tuple(args), keywords)
        state = (derivatives if derivatives is not None and given is f else derivatives_of(given)).state()
        if keywords or len(args) != len(state.parameters):
            args = tuple(bind(state.kernel, args, keywords))
        found = flatten(state, args)
        if found is None:
            return cls(state, args, f, None, args)
        with found.user_paths():
            return cls(found.state, found.values(args), found.carrier(f)[1], found, args)

    def values(self) -> list[Any]:
        """The arguments as the kernel takes them."""
        return [kernel_value(n, v, n in self.state.floats) for n, v in zip(self.state.parameters, self.args)]

    def user_paths(self) -> AbstractContextManager[None]:
        """Errors name the caller's paths."""
        return nullcontext() if self.structures is None else self.structures.user_paths()

    def wrt(self, names: tuple[str, ...] | None) -> tuple[str, ...] | None:
        """What names mean, each of them a float: an argument, or a part of one by its path."""
        structures = self.structures
        if names is None and selection_of(self.carrier).wrt is not None:
            return selection_of(self.carrier).wrt
        if structures is None:
            return names
        asked = structures.selected_paths(structures.independents() if names is None else names, "wrt")
        found = structures.flat_names(asked, "wrt")
        if len(found) > max(1, len(names or ())):
            said = f"wrt names '{names[0]}', which holds" if names else f"'{structures.title}' was given"
            parts = [structures.paths[n] for n in found]
            raise S2sadError(Diagnostic("S401", f"{said} {len(found)} floats: {', '.join(parts)}",
                                        help=f'a matrix is with respect to one: wrt="{parts[0]}"'))
        return found

    def outputs(self, names: tuple[str, ...] | None) -> tuple[str, ...] | None:
        """What names of outputs mean."""
        if names is None:
            return selection_of(self.carrier).of
        return names if self.structures is None else self.structures.outputs(names)

    def whole(self, name: str) -> str:
        """The name of an array or a number, which must not be a field that the kernel assigns."""
        if self.structures is not None and name in self.structures.cells:
            raise S2sadError(Diagnostic("S401", f"'{self.structures.paths[name]}' is a number that "
                                        f"'{self.structures.title}' assigns, which has no matrix",
                                        help="write a function that takes it as an argument, or returns it"))
        return name


def only_one(state: ProgramVersion, types: Sequence[Type], names: tuple[str, ...] | None) -> str:
    """The one parameter that is meant: it is named, or is the only float."""
    kinds = dict(zip(state.parameters, types))
    found = names if names is not None else tuple(n for n in state.kernel.independents if kinds[n].is_inexact)
    if len(found) != 1:
        said = f"wrt names {len(found)} parameters" if names is not None else (
            f"'{state.kernel.name}' has several arguments to differentiate with respect to: {', '.join(found)}"
            if found else f"'{state.kernel.name}' was given no float to differentiate with respect to")
        raise S2sadError(Diagnostic("S401", said, help='a matrix is with respect to one: wrt="x"'))
    return found[0]


def real(name: str, of: str, kind: Type) -> None:
    """Raises unless an argument or an output is real."""
    if kind.is_complex:
        raise S2sadError(Diagnostic("S401", f"{of} of '{name}' is complex, and a complex number has two directions",
                                    help="write a function of real and imaginary parts"))
