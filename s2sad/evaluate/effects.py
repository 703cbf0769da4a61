"""Which names may share memory, which name numbers for certain, and what a call of a user's function may write.

Nothing is known about types yet, so `row = x[i]` may be a view and is taken for one. Two parameters are
taken to be apart: arguments that overlap are refused at the call if either is written.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property

from s2sad.evaluate.mutating_calls import UNSUPPORTED, stored_by_call, stored_out
from s2sad.program import Program
from s2sad.rules import find
from s2sad.tree import (
    AST, AnnAssign, Assign, Attribute, AugAssign, BinOp, BoolOp, Call, Compare, Constant, For, FunctionDef, IfExp, List,
    Name, Store, Subscript, Tuple, UnaryOp, call_name, children, stored_names, walk, walk_statements,
)

# The results of these share no memory with their arguments.
FRESH = {"builtins." + f for f in "range len int float bool abs round".split()} | {
    "numpy." + f for f in "zeros ones empty full zeros_like ones_like empty_like full_like array copy arange linspace "
    "sqrt exp log sin cos tan tanh sum dot mean abs maximum minimum where outer eye concatenate stack roll diff "
    "cumsum cumprod matmul inner tensordot kron hstack vstack column_stack append tile repeat sort convolve prod std "
    "var clip linalg.solve linalg.inv linalg.pinv linalg.cholesky linalg.eigvalsh linalg.det linalg.norm".split()}
_GIVEN_BACK = {f"numpy.{f}" for f in ("real", "imag", "float64", "float32")}    # these may give what they are given
FRESH_METHODS = {"copy", "sum", "mean", "min", "max", "item", "dot", "prod"}
STABLE = {"shape", "size", "ndim", "dtype"}             # what a store into an array cannot change
GLOBAL = "array."


def fresh_value(value: AST) -> bool:
    """Whether an expression's value certainly shares no memory with anything it reads."""
    if isinstance(value, (Constant, BinOp, UnaryOp, Compare)):
        return True
    if isinstance(value, Attribute):
        return value.attr in STABLE
    if isinstance(value, Subscript):
        return isinstance(value.value, Attribute) and value.value.attr in STABLE
    if isinstance(value, (Tuple, List)):
        return all(map(fresh_value, value.elts))
    called = call_name(value)
    if stored_out(value) is not None or any(k.arg == "copy" for k in getattr(value, "keywords", [])):
        return False                                    # the array that it is given may be its result
    if called is not None:
        return called in FRESH or called.startswith("math.") or _is_new(called)
    return isinstance(value, Call) and isinstance(value.func, Attribute) and value.func.attr in FRESH_METHODS


def _is_new(called: str) -> bool:
    """Whether a function has a rule element by element, and so makes a new array of any."""
    return called.startswith(("numpy.", "scipy.special.")) and called not in _GIVEN_BACK and find(called) is not None


def parameters(function: FunctionDef) -> list[str]:
    return [a.id for a in (*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs)]


def bindings(function: FunctionDef) -> Iterable[tuple[AST, AST]]:
    """Every (target, value) of the function; a loop binds its target to what it goes through."""
    for node in walk_statements(function.body):
        if isinstance(node, Assign):
            yield from ((target, node.value) for target in node.targets)
        elif isinstance(node, AnnAssign) and node.value is not None:
            yield node.target, node.value
        elif isinstance(node, For):
            yield node.target, node.iter



class Memory:
    """Classes of names that may share memory, in one function; `bind` adds what a new statement binds."""

    def __init__(self, function: FunctionDef, program: Program):
        self._parent: dict[str, str] = {}
        self._program = program
        self._function = function
        for target, value in bindings(function):
            self.bind(stored_names(target), value)

    @cached_property
    def _scalars(self) -> set[str]:
        return _scalars(self._function)

    def bind(self, targets: list[str], value: AST) -> None:
        if fresh_value(value):
            return
        for target in targets:
            for source in _names(value):
                self._parent[self._class(target)] = self._class(source)

    def _class(self, identifier: str) -> str:
        while identifier in self._parent and self._parent[identifier] != identifier:
            identifier = self._parent[identifier]
        return identifier

    def written(self, statements: list[AST]) -> set[str]:
        """The classes whose memory these statements may write."""
        found: set[str] = set()
        for node in walk(statements):
            if isinstance(node, Subscript) and isinstance(node.ctx, Store):
                found |= {self._class(n) for n in _names(node.value)}
            elif isinstance(node, AugAssign) and isinstance(node.target, Name):
                found |= {self._class(node.target.id)} if node.target.id not in self._scalars else set()
            elif (called := call_name(node) or "").startswith("user.") and self.writes(called[len("user."):]):
                found |= {self._class(n) for n in _names(node.args + node.keywords)} | {GLOBAL}
            elif isinstance(node, Call) and is_writing_call(node):
                found |= {self._class(n) for n in _names(node)}
        return found

    def affected(self, expression: AST, written: set[str]) -> bool:
        """Whether the expression, evaluated after these writes, may have another value than before them."""
        if not written or isinstance(expression, (Name, Constant)):
            return False
        if isinstance(expression, (Tuple, List)):
            return any(self.affected(item, written) for item in expression.elts)
        return any(GLOBAL in written if n.startswith(GLOBAL) else self._class(n) in written
                   for n in _names(expression) if n not in self._scalars)

    def writes(self, kernel: str) -> bool:
        """Whether a call of the kernel may write memory that it did not allocate itself."""
        return kernel not in self._program.kernels or kernel in self._program.once(writers)


def writers(program: Program) -> frozenset[str]:
    """The kernels that may write memory that they did not allocate themselves."""
    found: set[str] = set()
    for title, kernel in program.kernels.items():  # callees first
        if _writes(kernel.tree, lambda called: called not in program.kernels or called in found):
            found.add(title)
    return frozenset(found)


def _writes(function: FunctionDef, callee_writes: Callable[[str], bool]) -> bool:
    own = set(stored_names(function.body)) - set(parameters(function))
    for target, value in bindings(function):
        if not fresh_value(value):
            own -= set(stored_names(target))
    for node in walk(function.body):
        if isinstance(node, AugAssign) and isinstance(node.target, Name) and node.target.id not in own:
            return True
        if isinstance(node, Subscript) and isinstance(node.ctx, Store) and not set(_names(node.value)) <= own:
            return True
        called = call_name(node) or ""
        if called.startswith("user.") and callee_writes(called[len("user."):]):
            return True
        if isinstance(node, Call) and is_writing_call(node):
            return True
    return False


def is_writing_call(node: Call) -> bool:
    """Whether a call of a library's function or of a method writes an array that it is given."""
    attr = node.func.attr if isinstance(node.func, Attribute) else ""
    return attr in ("fill", "sort", "resize", "put", "itemset", "partition") or attr.startswith("__") or (
        call_name(node) in UNSUPPORTED or stored_by_call(node) is not None or any(
            k.arg == "out" for k in node.keywords))


def _names(node: AST | list[AST]) -> list[str]:
    """The names whose content an expression reads: kernel names and global arrays, but not for their shape."""
    found: list[str] = []
    stack = list(node) if isinstance(node, list) else [node]
    while stack:
        current = stack.pop()
        if isinstance(current, Attribute) and current.attr in STABLE and isinstance(current.value, Name):
            continue
        if call_name(current) == "builtins.len" and current.args and isinstance(current.args[0], Name):
            continue
        if isinstance(current, Name) and ("." not in current.id or current.id.startswith(GLOBAL)):
            found.append(current.id)
        stack += children(current)
    return found


def _scalars(function: FunctionDef) -> set[str]:
    """The names that are bound to numbers only, as far as the text shows it: `w += x` may make an array of one."""
    bound = [*bindings(function), *((n.target, n.value) for n in walk_statements(function.body)
                                    if isinstance(n, AugAssign))]
    found = set(stored_names(function.body)) - set(parameters(function))
    while True:
        lost = {n for target, value in bound if not (isinstance(target, Name) and _number(value, found))
                for n in stored_names(target)} & found
        if not lost:
            return found
        found -= lost


def _number(value: AST, scalars: set[str]) -> bool:
    if isinstance(value, Constant):
        return True
    if isinstance(value, Name):
        return value.id in scalars or value.id.startswith(("const.", "numpy.", "math."))
    if isinstance(value, BinOp):
        return _number(value.left, scalars) and _number(value.right, scalars)
    if isinstance(value, UnaryOp):
        return _number(value.operand, scalars)
    if isinstance(value, BoolOp):
        return all(_number(v, scalars) for v in value.values)
    if isinstance(value, Compare):
        return all(_number(v, scalars) for v in [value.left, *value.comparators])
    if isinstance(value, IfExp):
        return _number(value.body, scalars) and _number(value.orelse, scalars)
    if isinstance(value, Attribute):
        return value.attr in ("size", "ndim")
    if isinstance(value, Subscript):
        return isinstance(value.value, Attribute) and value.value.attr == "shape"
    called = call_name(value) or ""
    return called in ("builtins.len", "builtins.int", "builtins.float", "builtins.range") or called.startswith("math.")
