"""numpy_scalars: for the NumPy engine, what raises with Python's own numbers is done with NumPy's, which give inf or
nan.

    def f_adjoint(x, n, y_bar):             def f_adjoint(x, n, y_bar):
                                                x = np.float64(x)
        x_bar = y_bar / x                       x_bar = y_bar / x
        h = 1.0 / n                             h = 1.0 / np.float64(n)
        return math.sqrt(h)                     return np.sqrt(h)
        1j / x                                  np.divide(1j, x)

`math` gives way to NumPy. A quotient, remainder or power raises only if both operands are Python's: one that is a
float parameter, or is made of such, becomes NumPy's where it is bound; else an operand is converted where it stands.
Functions of any form go in, and come out in the same. Integers raise as in the kernel (`n % 0`, `math.isqrt(-1)`,
`int(nan)`): they have no inf.
"""
from __future__ import annotations

from collections.abc import Mapping, Set

from s2sad.emit.scalar_kinds import CHOICES, CONVERT, FLOAT, INT, NARROW, OF_MATH, ScalarKinds
from s2sad.infer.types import Type
from s2sad.tree import (
    AST, Assign, AugAssign, BinOp, BoolOp, Call, Compare, Constant, Div, Expr, FunctionDef, IfExp, Name, Subscript,
    UnaryOp, USub, assign, at, call, call_name, function, is_comment, name, placed, rebuild, walk,
)

Types = Mapping[str, Mapping[str, Type]]


def numpy_scalars(functions: list[FunctionDef], types: Types, constants: Mapping[str, object]) -> list[FunctionDef]:
    """The functions of a module, callees first; `types` has their parameters and arrays, by function, `constants` the
    values behind `const.` names."""
    results: dict[str, list[int]] = {}
    for tree in functions:
        first = _NumpyScalars(tree, types.get(tree.name, {}), constants, [], results)
        first.choose_conversions()
        results[tree.name] = first.whose.returned()
    made: list[FunctionDef] = []
    calls: dict[str, list[list[int]]] = {}
    for tree in reversed(functions):
        known = [max(kinds) for kinds in zip(*calls.get(tree.name, []))]
        last = _NumpyScalars(tree, types.get(tree.name, {}), constants, known, results)
        last.choose_conversions()
        made.insert(0, last.converted())
        for node in walk(tree.body):
            module, _, callee = (call_name(node) or "").partition(".")
            if module == "user":
                calls.setdefault(callee, []).append([last.whose.kind(a) for a in node.args])
    return made


class _NumpyScalars:
    """One function: the names to convert, and its new tree."""

    def __init__(self, tree: FunctionDef, types: Mapping[str, Type], constants: Mapping[str, object],
                 known: list[int], results: Mapping[str, list[int]]):
        self.tree, self.constants = tree, constants
        self.whose = ScalarKinds(tree, types, constants, known, results)
        self.before = ScalarKinds(tree, types, constants, known, results, as_it_is=True)
        self.tests = _names_of_tests(self.whose.bound)
        self.never: set[str] = set()        # names that cannot be NumPy's, as far as others are

    def choose_conversions(self) -> None:
        """Chooses the names that are converted where they are bound."""
        risky = [BinOp(n.target, n.op, n.value) if isinstance(n, AugAssign) else n for n in walk(self.tree.body)
                 if isinstance(n, (AugAssign, BinOp))]
        count = -1
        while count != len(self.whose.converted):
            count = len(self.whose.converted)
            for node in filter(self.whose.raises, risky):
                if not self.whose.is_complex(node):
                    self.convert_operand(node)

    def converted(self) -> FunctionDef:
        body = [self.statement(s) for s in self.tree.body]
        parameters = self.whose.parameters
        top = [assign(p, call(CONVERT, name(p))) for p in parameters if p in self.whose.converted]
        said = int(bool(body) and isinstance(body[0], Expr) and isinstance(body[0].value, Constant)
                   and not is_comment(body[0]))
        made = function(self.tree.name, parameters, [*body[:said], *top, *body[said:]])
        return at(made, self.tree) if getattr(self.tree, "lineno", None) else made

    # -- who is converted where it is bound -------------------------------------------------------------------------

    def convert_operand(self, node: BinOp) -> None:
        """Converts what makes an operand NumPy's, if that can be."""
        operands = [node.right, node.left] if isinstance(node.op, Div) else [node.left, node.right]
        for operand in operands:
            trail: dict[str, None] = {}
            if self.can_be_numpys(operand, trail):
                self.whose.converted |= trail.keys()
                self.whose.find()
                self.never.clear()
                return

    def can_be_numpys(self, node: AST, trail: dict[str, None]) -> bool:
        """Whether an expression is NumPy's if names are converted where they are bound, which go to the trail."""
        if self.whose.kind(node) <= NARROW:
            return True
        if isinstance(node, Name):
            return self.can_name_be_numpys(node.id, trail)
        if isinstance(node, UnaryOp):
            return self.can_be_numpys(node.operand, trail)
        if isinstance(node, BinOp):
            return self.can_be_numpys(node.left, trail) or self.can_be_numpys(node.right, trail)
        parts = [node.body, node.orelse] if isinstance(node, IfExp) else node.args if isinstance(
            node, Call) and call_name(node) in CHOICES else None
        before = len(trail)
        found = parts is not None and all(self.can_be_numpys(part, trail) for part in parts)
        return found or _shorten(trail, before)

    def can_name_be_numpys(self, identifier: str, trail: dict[str, None]) -> bool:
        if identifier in trail or identifier in self.never:
            return identifier in trail
        values = self.whose.bound.get(identifier, [])
        number = identifier in self.whose.parameters and self.whose.kinds[identifier] == FLOAT
        before, found = len(trail), number or bool(values) and self.whose.kinds.get(identifier) == FLOAT
        trail[identifier] = None
        if found and all(isinstance(value, Constant) or (self.can_be_numpys(value, trail) if isinstance(value, AST)
                                                         else value <= NARROW) for value in values):
            return True
        self.never.add(identifier)
        return _shorten(trail, before)

    # -- the text ---------------------------------------------------------------------------------------------------

    def statement(self, statement: AST) -> AST:
        new = rebuild(statement, self.expression)
        for part in walk(new):
            target = part.targets[0] if isinstance(part, Assign) else None
            if isinstance(target, Name) and target.id in self.whose.converted and isinstance(part.value, Constant):
                part.value = call("numpy.complex128" if isinstance(part.value.value, complex) else CONVERT, part.value)
        return new

    def expression(self, node: AST) -> AST | None:
        """What takes the place of an expression, None if it stays."""
        if isinstance(node, AugAssign) and self.whose.raises(
                BinOp(node.target, node.op, node.value)) and not isinstance(node.target, Subscript):
            return at(AugAssign(node.target, node.op, call(CONVERT, rebuild(node.value, self.expression))), node)
        if isinstance(node, BinOp):
            return self.operation(node)
        if call_name(node) in OF_MATH:
            return self.of_math(node)
        if isinstance(node, UnaryOp) and isinstance(node.op, USub) and self.is_converted_bool(node.operand):
            return UnaryOp(node.op, call("builtins.int", rebuild(node.operand, self.expression)))
        return None

    def of_math(self, node: Call) -> AST:
        """NumPy's function; `math` computes with 64 bits whatever its arguments."""
        args = [rebuild(a, self.expression) for a in node.args]
        if any(self.whose.kind(a) == NARROW for a in node.args):
            args[0] = call(CONVERT, args[0])
        made = call(OF_MATH[call_name(node) or ""], *args)
        return at(made, node) if getattr(node, "lineno", None) else made

    def operation(self, node: BinOp) -> AST | None:
        left, right = (rebuild(n, self.expression) for n in (node.left, node.right))
        if self.is_converted_bool(node.left) and self.is_converted_bool(node.right):
            left = call("builtins.int", left)
        if self.whose.raises(node) and self.whose.is_complex(node):
            made = call("numpy.divide" if isinstance(node.op, Div) else "numpy.power", left, right)
            return placed(made, node)
        if self.whose.raises(node):
            if isinstance(node.op, Div):
                right = call(CONVERT, right)
            else:
                left = call(CONVERT, left)
        made = BinOp(left, node.op, right)
        return placed(made, node)

    def is_converted_bool(self, node: AST) -> bool:
        """Whether a conversion has made a bool NumPy's, whose arithmetic is another one."""
        return (_is_test(node, self.tests) and self.whose.kind(node) <= NARROW
                and self.before.kind(node) == INT)


def _shorten(trail: dict[str, None], length: int) -> bool:
    """Takes back what was found since; False."""
    while len(trail) > length:
        trail.popitem()
    return False


def _names_of_tests(bound: Mapping[str, list[AST | int]]) -> set[str]:
    found, before = set[str](), -1
    while len(found) > before:
        before = len(found)
        for identifier, values in bound.items():
            if identifier not in found and any(isinstance(v, AST) and _is_test(v, found) for v in values):
                found.add(identifier)
    return found


def _is_test(node: AST, tests: Set[str]) -> bool:
    if isinstance(node, Name):
        return node.id in tests
    return isinstance(node, Compare) or isinstance(node, BoolOp) and any(_is_test(v, tests) for v in node.values)
