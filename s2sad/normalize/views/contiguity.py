"""contiguity: which arrays are contiguous, in C's order, so that NumPy reshapes them without a copy.

Requires structured form in which functions of whole arrays stand alone. What NumPy makes keeps the order of what it is
made from; a parameter lies as the caller has it, which is a guard's to ask.

    f = np.ravel(u)                 assert u.flags.c_contiguous
    f[0] = 1.0                      f = np.ravel(u)
                                    f[0] = 1.0

An order that is requested, as in `np.copy(u, order="F")`, goes before that; one other than C's is that of a copy.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence, Set

from s2sad import rules
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import whole_number
from s2sad.infer.slice_extents import is_whole
from s2sad.normalize.context import NormalContext
from s2sad.normalize.shape_guards import contiguous
from s2sad.tree import (
    AST, Assign, BinOp, Call, Constant, FunctionDef, Name, Slice, Store, Subscript, UnaryOp, at, call_name, copy,
    indices, name, user_call, walk,
)

Asked = Callable[[Call], Sequence[int]]
_ALLOCATING = {f"numpy.{f}" for f in "zeros empty ones full dot outer eye arange linspace".split()}
_LIKE = {f"numpy.{f}" for f in ("zeros_like", "empty_like", "ones_like", "full_like", "copy", "array")}
_SAME_MEMORY = {f"numpy.{f}" for f in ("asarray", "ascontiguousarray", "reshape", "ravel")}
_PERMUTING = {f"numpy.{f}" for f in (
    "transpose", "flip", "fliplr", "flipud", "rot90", "squeeze", "swapaxes", "moveaxis", "expand_dims", "atleast_1d",
    "atleast_2d", "atleast_3d", "broadcast_to", "diagonal", "diag", "split", "array_split", "hsplit", "vsplit", "real",
    "imag", "lib.stride_tricks.sliding_window_view")}


class Contiguity:
    """The parameters of one function that must be contiguous for its arrays to be; `unknown` are names of arrays that
    are others in NumPy, which may lie otherwise: elements of lists, results of a called function."""

    def __init__(self, function: FunctionDef, typing: Typing, unknown: Set[str] = frozenset()):
        self.typing, self.unknown = typing, unknown
        self.parameters = {p.id for p in function.args.args}
        self.bound: dict[str, list[AST | None]] = {}
        for statement in walk(function.body):
            target = statement.targets[0] if isinstance(statement, Assign) else None
            for n in walk(target) if target is not None else ():
                if isinstance(n, Name) and isinstance(n.ctx, Store):
                    self.bound.setdefault(n.id, []).append(statement.value if n is target else None)
        self._known: dict[str, frozenset[str] | None] = {}

    def rebind(self, identifier: str, other: str) -> None:
        """Another name is bound to what a name is bound to."""
        self.bound[other] = self.bound.get(identifier, [None])

    def needs(self, node: AST) -> frozenset[str] | None:
        """The parameters that must be contiguous for an array to be; None if it may not be even then."""
        if isinstance(node, Name):
            return self._name(node.id)
        if isinstance(node, Subscript):
            if self._is_contiguous_part(node):
                return self.needs(node.value)
            return self._fresh(node) if self._picks(node) else None
        called = call_name(node)
        if called is None:
            plain = isinstance(node, (BinOp, UnaryOp))
            return self._elementwise(node) if plain else None
        if called in _ALLOCATING or called in _LIKE or called in _SAME_MEMORY:
            return self._allocation_order(called, node)
        if called == "numpy.matmul":    # of stacks, and what einsum becomes, is ordered as the operands are
            return frozenset() if self.typing.of(node).rank < 2 else self._elementwise(node)
        if called in _PERMUTING or called.startswith("user."):
            return None
        return self._elementwise(node) if rules.find_array(called) is None else self._fresh(node)

    def _allocation_order(self, called: str, node: Call) -> frozenset[str] | None:
        """A new array lies in the order that is requested, else in NumPy's, or in that of what it is made from."""
        order = requested_order(node)
        if order == "C" or called == "numpy.ascontiguousarray" or called in _ALLOCATING and order == "K":
            return frozenset()
        inner = node.args[0]
        if order != "K":
            return self._fresh(node)
        if not self.typing.of(inner).is_array or not isinstance(inner, (Name, Subscript, Call, BinOp, UnaryOp)):
            return frozenset()
        fresh = None if called in _SAME_MEMORY else self._fresh(node)
        return fresh if fresh is not None else self.needs(inner) if called in _SAME_MEMORY else self._ordered(inner)

    def _name(self, identifier: str) -> frozenset[str] | None:
        if identifier not in self._known:
            found: frozenset[str] | None = frozenset({identifier} & self.parameters)
            if identifier in self.unknown:
                return self._fresh(name(identifier))
            if not found and identifier not in self.bound:
                return None
            self._known[identifier] = found     # where it is made from itself
            for value in self.bound.get(identifier, ()):
                inner = None if value is None else self.needs(value)
                found = None if found is None or inner is None else found | inner
            self._known[identifier] = found
        return self._known[identifier]

    def _fresh(self, node: AST) -> frozenset[str] | None:
        """Of what a function allocates is known that it is contiguous where it has one axis."""
        return frozenset() if self.typing.of(node).rank <= 1 else None

    def _elementwise(self, node: AST) -> frozenset[str] | None:
        """An expression's array has its axes in the order of its operands'."""
        if (found := self._fresh(node)) is not None:
            return found
        found = frozenset()
        parts = [*node.args] if isinstance(node, Call) else [node.operand] if isinstance(node, UnaryOp) else [
            node.left, node.right] if isinstance(node, BinOp) else None
        for part in parts if parts is not None else ():
            if self.typing.of(part).is_array:
                inner = self._ordered(part)
                if inner is None:
                    return None
                found |= inner
        return found if parts else None

    def _ordered(self, node: AST) -> frozenset[str] | None:
        """The same for an array's axes to be in the order of how far their elements lie apart."""
        plain = isinstance(node, Subscript) and not self._picks(node)
        return self._ordered(node.value) if plain else self.needs(node)

    def _picks(self, node: Subscript) -> bool:
        return any(not isinstance(s, Slice) and self.typing.of(s).is_array for s in indices(node))

    def _is_contiguous_part(self, node: Subscript) -> bool:
        """Whether a subscript takes a contiguous part: numbers first, a slice of one axis, then all of the others."""
        if self._picks(node):
            return False
        sliced = False
        for subscript in indices(node):
            if isinstance(subscript, Constant) and subscript.value is None or is_whole(subscript) and sliced:
                continue
            if not isinstance(subscript, Slice):
                if sliced:
                    return False
                sliced = isinstance(subscript, Constant) and subscript.value is Ellipsis
            elif sliced or subscript.step is not None and whole_number(subscript.step) != 1:
                return False
            sliced = sliced or isinstance(subscript, Slice)
        return True


def requested_order(node: Call) -> str:
    """The order in memory that a call requests: "C", "F", "K" for its operand's; "" if it is not certain."""
    orders = [k.value for k in node.keywords if k.arg == "order"]
    order = orders[0].value if orders and isinstance(orders[0], Constant) else "" if orders else None
    return "K" if order is None else known if (known := str(order).upper()) in ("C", "F", "K") else ""


def contiguous_arguments(function: FunctionDef, context: NormalContext) -> None:
    """Refuses arrays that a function reshapes and stores into and that may not be contiguous where it is called.

        def flat(u):
            r = np.ravel(u)
            r[0] = 2.0 * r[1]


        def f(u: float64[:, :]):
            flat(u[:, 1:])
            return u[0, 1]

    refused: an array that the function reshapes and writes may not be contiguous here

    Requires structured form in which functions of whole arrays stand alone; establishes that the context has the
    parameters that must be contiguous for the functions called.
    """
    found, whole, report = context.contiguous, context.contiguity, context.report
    for node in walk(function.body):
        if user_call(node):
            called = context.callees.of_call(node, context.typing)
            for argument in (node.args[k] for k in called.contiguous):
                needed = whole.needs(argument)
                if needed is None:
                    report.error("S201", "an array that the function reshapes and writes may not be contiguous here: "
                                 "NumPy would write a copy", argument,
                                 help="give it a copy that np.zeros(...) allocates, or write it as a loop")
                found |= needed or set()


def contiguity_guards(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with a guard for each parameter that must be contiguous.

        def f(u: float64[:, :]):            def f(u):
            r = np.ravel(u)                     assert u.flags.c_contiguous
            r[0] = 2.0 * r[1]                   r = np.empty(u.shape[0] * u.shape[1])
            return u[0, 0]                      r[...] = np.ravel(u)
                                                ...
                                                return u[0, 0]

    Requires views resolved, and the parameters that must be contiguous in the context; establishes that generated code
    asks for them.
    """
    needed = context.contiguous
    new = copy(function)
    new.body = [*(at(contiguous(name(p.id)), function) for p in function.args.args if p.id in needed), *new.body]
    return new
