"""array_anf: every function of whole arrays stands alone, on arrays that have names.

Requires structured form and types; establishes that a function of whole arrays is the whole right side of a statement
that binds a name, and that its operands are names and parts of arrays; what is summed may be an expression.

    def f(w: "float64[:, :]", u, b, x):         def f(w, u, b, x):
        hidden = np.tanh(w @ u[:] + b[:])           matmul_value = np.matmul(w, u[:])
        x[x > 1.0] = 0.0                            hidden = np.tanh(matmul_value + b[:])
        return np.sum(hidden) + x[0]                mask = x > 1.0
                                                    x[mask] = 0.0
                                                    return np.sum(hidden) + x[0]

What an array of bools picks stands alone, too, but in a statement that fills what the same one picks.
"""
from __future__ import annotations

from s2sad import rules
from s2sad.liveness import base_name
from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import axes_of
from s2sad.naming import Names
from s2sad.normalize.loops.element_of import moves
from s2sad.passes import Context
from s2sad.tree import (
    AST, Assign, AugAssign, BinOp, Break, Call, Constant, Expr, For, FunctionDef, If, List, Name, Return, Slice,
    Subscript, Tuple, UnaryOp, While, assign, at, attribute, augment, call, call_name, const, copy, dump, index,
    indices, keyword, name, names, rebuild, user_call, walk, with_body,
)

_SUMMED = ("summed", "averaged")
_MADE = {f"numpy.{made}{like}" for made in ("empty", "zeros", "ones", "full") for like in ("", "_like")} | {
    "numpy.array", "numpy.copy", "numpy.asarray", "numpy.ascontiguousarray"}

_FILLED = {"numpy.full": 1, "numpy.full_like": 1, "numpy.array": 0, "numpy.copy": 0, "numpy.asarray": 0,
           "numpy.ascontiguousarray": 0}       # where the argument is that an array is filled with


def array_anf(function: FunctionDef, context: Context) -> FunctionDef:
    """A kernel's function with those names."""
    return named_arrays(function, context.typing, context.names, context.in_loops)


def array_anf_added(function: FunctionDef, context: Context) -> FunctionDef:
    """A derivative with those names, but for what only moves elements that are added to others.

        def f(x: float64[:, :], y: float64[:]):
            y[:] = x @ y

    in its adjoint:

        def f_adjoint(...):                                     def f_adjoint(...):
            ...                                                     ...
            y_bar[...] += np.matmul(np.transpose(x), seed_2)        transpose_value = np.transpose(x)
                                                                    matmul_value = np.matmul(transpose_value, seed_2)
                                                                    y_bar[...] += matmul_value
    """
    return named_arrays(function, context.typing, context.names, added=True)


def named_arrays(function: FunctionDef, typing: Typing, free: Names, loops: bool = False,
                 added: bool = False) -> FunctionDef:
    """The function with those names; the table of `typing` gains them. Where loops take their place (`loops`), what
    grows side by side in a loop of the kernel grows in an array of its own: its steps are not recorded. With `added`,
    a function that only moves elements needs no name where its elements are added to those of another array."""
    return with_body(function, _ArrayAnf(typing, free, loops, added).block(function.body))


def is_function(node: AST) -> bool:
    """Whether an expression is a call of a function of whole arrays that stands alone: a sum of everything may stand
    in an expression."""
    rule = rules.find_array(call_name(node))
    return rule is not None and not (rule.name == "numpy.sum" and not node.keywords)


def multiplies_part(node: AST, typing: Typing) -> bool:
    """Whether an expression is a part of a matrix, whose rows lie apart in memory, times a vector: compiled code copies
    such a part to multiply it, loops read it where it is."""
    if call_name(node) != "numpy.matmul" or not isinstance(node, Call) or not isinstance(node.args[0], Subscript):
        return False
    matrix, kinds = node.args[0], [typing.of(a) for a in node.args]
    last = indices(matrix)[-1]
    return len(indices(matrix)) == typing.of(matrix.value).rank and isinstance(last, Slice) and (
        last.lower is not None or last.upper is not None) and [k.rank for k in kinds] == [2, 1] and all(
        k.dtype == "float64" for k in kinds)


class _ArrayAnf:
    def __init__(self, typing: Typing, free: Names, loops: bool, added: bool):
        self.typing, self.free, self.loops, self.added = typing, free, loops, added
        self.target_mask = ""  # the array of bools that the statement's target is picked by
        self.depth = 0

    def block(self, block: list[AST]) -> list[AST]:
        return [at(made, s) for s in block for made in self.statement(s)]

    def repeated(self, block: list[AST]) -> list[AST]:
        """The block of a loop."""
        self.depth += 1
        made = self.block(block)
        self.depth -= 1
        return made

    def statement(self, statement: AST) -> list[AST]:
        before: list[AST] = []
        self.target_mask = ""
        if isinstance(statement, For):
            bounds = self.hoisted(statement.iter, before)
            return [*before, For(statement.target, bounds, self.repeated(statement.body), [], None)]
        if isinstance(statement, While):
            return self.loop(statement)
        if isinstance(statement, If):
            test = self.hoisted(statement.test, before)
            return [*before, If(test, self.block(statement.body), self.block(statement.orelse))]
        if isinstance(statement, (Assign, AugAssign)):
            return self.assignment(statement, before)
        if isinstance(statement, Return) and statement.value is not None:
            value = self.hoisted(statement.value, before)
            return [*before, Return(value)]
        if isinstance(statement, Expr) and (called := statement.value) is not None and user_call(called):
            value = self.hoisted(called, before)
            return [*before, Expr(value)]
        return [statement]

    def assignment(self, statement: Assign | AugAssign, before: list[AST]) -> list[AST]:
        target = statement.targets[0] if isinstance(statement, Assign) else statement.target
        if isinstance(statement.value, (List, Tuple)) and self.typing.of(target).is_array and not (
                isinstance(target, Name) and isinstance(statement, Assign)):
            statement = copy(statement)
            statement.value = at(call("numpy.array", statement.value), statement)
        if isinstance(target, Subscript) and self.index_arrays(target):
            target = self.with_named_arrays(target, before)
            masks = [dump(s) for s in self.index_arrays(target) if self.typing.of(s).dtype == "bool"]
            self.target_mask = masks[0] if masks else ""
            if isinstance(statement, AugAssign) and not masks:  # NumPy reads all elements before it fills one
                statement = at(assign(target, BinOp(copy(target), statement.op, statement.value)), statement)
        elif isinstance(target, Subscript):
            target = self.hoisted(target, before)
        if isinstance(statement, AugAssign):
            alone = self.added and base_name(target) not in names(statement.value) and (
                moves(statement.value) or multiplies_part(statement.value, self.typing))
            value = self.operands(statement.value, before) if alone else self.hoisted(statement.value, before)
            return [*before, augment(target, statement.op, value)]
        if self.grows_in_loop(statement.value):
            made = name(self.bind(statement.value, self.right_side(statement.value, before), before))
            return [*before, assign(target, call("numpy.copy", made) if isinstance(target, Name) else made)]
        binds = isinstance(target, Name) or is_function(statement.value)
        value = self.right_side(statement.value, before) if binds else self.hoisted(statement.value, before)
        return [*before, assign(target, value)]

    def grows_in_loop(self, node: AST) -> bool:
        """Whether a call in a loop is a sum of rows, whose elements grow side by side."""
        rule = rules.find_array(call_name(node))
        if not self.loops or not self.depth or rule is None or rule.law not in _SUMMED or not isinstance(node, Call):
            return False
        rank = self.typing.of(node.args[0]).rank
        axes = axes_of(rule.arguments(node)["axis"], rank)
        return bool(axes) and len(axes) < rank and min(axes) < max(set(range(rank)) - set(axes))

    def loop(self, statement: While) -> list[AST]:
        before: list[AST] = []
        test = self.hoisted(statement.test, before)
        body = self.repeated(statement.body)
        if not before:
            return [While(statement.test, body, [])]
        return [While(const(True), [*before, If(test, body, [at(Break(), statement)])], [])]

    def hoisted(self, node: AST, before: list[AST]) -> AST:
        """The expression with its functions of whole arrays bound to names before."""
        def change(n: AST) -> AST | None:
            if isinstance(n, Subscript) and self.index_arrays(n):
                return self.gathered(n, before)
            if isinstance(n, Subscript) and self.typing.of(n.value).is_array and (
                    not isinstance(n.value, (Name, Subscript)) or self.is_gather(n.value)):
                inner = name(self.bind(n.value, self.right_side(n.value, before), before))
                return at(Subscript(inner, self.hoisted(n.slice, before), n.ctx), n)
            if call_name(n) in _MADE:
                return name(self.bind(n, self.allocated(n, before), before))
            if call_name(n) == "numpy.size" and (sized := self.sized(n.args[0])) is not None:
                return at(attribute(self.hoisted(sized, before), "size"), n)
            if user_call(n):
                return at(Call(n.func, [self.named_argument(a, before) for a in n.args], n.keywords), n)
            if rules.find_array(call_name(n)) is None:
                return None
            kept, self.target_mask = self.target_mask, ""  # it does not walk what a mask of the statement picks
            made = self.operands(n, before)
            self.target_mask = kept
            return name(self.bind(n, made, before)) if is_function(n) else made
        return rebuild(node, change)

    def sized(self, node: AST) -> AST | None:
        """An array in an expression over numbers and arrays with one axis, whose size is the expression's."""
        plain = isinstance(node, (BinOp, UnaryOp)) and self.typing.of(node).rank == 1 and not any(
            isinstance(n, Call) or self.is_gather(n) for n in walk(node))
        parts = [n for n in walk(node) if isinstance(n, (Name, Subscript)) and self.typing.of(n).rank == 1
                 and not self.typing.argument(n).ones] if plain else []
        inside = {id(m) for n in parts for m in walk(n) if m is not n}
        return next((n for n in parts if id(n) not in inside), None)

    def named_argument(self, argument: AST, before: list[AST]) -> AST:
        """An argument of a kernel's call: an array that is computed or picked has a name, and a shadow of its own."""
        inner = self.hoisted(argument, before)
        computed = self.typing.of(inner).is_array and (
            not isinstance(inner, (Name, Subscript)) or self.is_gather(inner))
        return name(self.bind(argument, inner, before)) if computed else inner

    def index_arrays(self, node: Subscript) -> list[AST]:
        """The arrays among the subscripts."""
        return [s for s in indices(node) if not isinstance(s, Slice) and self.typing.of(s).is_array]

    def is_gather(self, node: AST) -> bool:
        """Whether an expression is elements that arrays pick, which are a copy."""
        return isinstance(node, Subscript) and bool(self.index_arrays(node))

    def gathered(self, node: Subscript, before: list[AST]) -> AST:
        """The elements that arrays pick: the arrays have names, and what a mask picks has one."""
        place = self.with_named_arrays(node, before)
        mask = next((s for s in self.index_arrays(place) if self.typing.of(s).dtype == "bool"), None)
        if mask is None or dump(mask) == self.target_mask:
            return place
        return name(self.bind(node, place, before, "picked"))

    def with_named_arrays(self, node: Subscript, before: list[AST]) -> Subscript:
        """The subscript with names for the arrays in it."""
        arrays = self.index_arrays(node)
        base = self.hoisted(node.value, before)
        if not isinstance(base, (Name, Subscript)) or self.is_gather(base):
            base = name(self.bind(node.value, base, before))
        parts = [self.named_index_array(s, before) if s in arrays else self.hoisted(s, before) for s in indices(node)]
        return at(Subscript(base, index(node.value, *parts).slice, node.ctx), node)

    def named_index_array(self, array: AST, before: list[AST]) -> AST:
        """A name for an array of subscripts; a part of an array is copied."""
        if isinstance(array, Name):
            return array
        made = self.hoisted(array, before)
        value = call("numpy.copy", made) if isinstance(made, Subscript) else made
        return name(self.bind(array, value, before, "mask" if self.typing.of(array).dtype == "bool" else "places"))

    def right_side(self, node: AST, before: list[AST]) -> AST:
        """The right side of a statement that binds a name."""
        if call_name(node) in _MADE:
            return self.allocated(node, before)
        if isinstance(node, Subscript) and self.index_arrays(node):
            return self.with_named_arrays(node, before)
        return self.operands(node, before) if is_function(node) else self.hoisted(node, before)

    def allocated(self, node: AST, before: list[AST]) -> AST:
        """An allocation, with names for the functions in what it is filled with, item by item."""
        made, place = copy(node), _FILLED.get(call_name(node) or "")
        if place is not None:
            made.args[place] = self.items(made.args[place], before)
        return made

    def items(self, node: AST, before: list[AST]) -> AST:
        if not isinstance(node, (List, Tuple)):
            return self.hoisted(node, before)
        return at(type(node)([self.items(item, before) for item in node.elts], node.ctx), node)

    def operands(self, node: Call, before: list[AST]) -> Call:
        """The call with operands that are names or parts of arrays."""
        rule = rules.find_array(call_name(node))
        assert rule is not None
        made: list[AST] = []
        for operand in node.args:
            inner = self.hoisted(operand, before)
            plain = isinstance(inner, (Name, Subscript, Constant)) and not self.is_gather(inner) or not self.typing.of(
                inner).is_array
            summed = rule.law in _SUMMED and any(isinstance(n, (Name, Subscript)) and self.typing.of(n).is_array
                                                 for n in walk(inner))
            converted = self.converted(inner, operand, node)
            made.append(inner if converted is inner and (plain or summed)
                        else name(self.bind(operand, converted, before)))
        options = [at(keyword(k.arg, self.hoisted(k.value, before)), node) for k in node.keywords]
        return at(Call(node.func, made, options), node)

    def converted(self, operand: AST, origin: AST, node: Call) -> AST:
        """An operand of a product or a solve in the dtype of the result: what computes these mixes none."""
        called, given, made = call_name(node) or "", self.typing.of(operand), self.typing.of(node)
        mixed = given.is_array and given.dtype != made.dtype and made.is_inexact
        rule = rules.find_array(called)
        sparse = called.startswith("runtime.sparse_") and rule is not None and any(
            node.args[k] is origin for k, p in enumerate(rule.operands) if p in rule.adjoints)
        dense = called in ("numpy.matmul", "numpy.dot") or called.startswith("numpy.linalg.")
        if not mixed or not (dense or sparse):
            return operand
        return at(call("numpy.astype", operand, dtype=name(f"numpy.{made.dtype}")), node)

    def bind(self, origin: AST, value: AST, before: list[AST], called: str = "") -> str:
        wanted = (call_name(origin) or "operand").rpartition(".")[2]
        made_there = is_function(origin) or call_name(origin) in _MADE
        made = self.free.fresh(called or (f"{wanted}_value" if made_there else "operand"))
        self.typing.declare(made, self.typing.argument(value))
        before.append(at(assign(made, value), origin))
        return made
