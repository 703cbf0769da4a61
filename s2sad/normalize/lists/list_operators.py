"""list_operators: what lies in a list and is a list or a tuple itself is joined, repeated and compared as Python
does it.

    def f(x, n):                        def f(x, n):
        t = []                              t = list(len(range(n)))
        for k in range(n):                  t_count = 0
            t.append((x[k], 2.0))           for k in range(n):
        u = t[0] + t[1]                         t[k] = np.array((x[k], 2.0))
        return u[3] * x[0]                      t_count += 1
                                            u = np.concatenate((t[element(0, len(t))], t[element(1, len(t))]))
                                            return u[3] * x[0]

Requires structured form and types, and that `growing` has left marks (MARKS) on such rows: in the array in place of a
list they are rows like any other, whose operators are NumPy's. Establishes that there are no marks. An operator that
would need more than this, and a function whose argument is such a row and that would, are refused.
"""
from __future__ import annotations

from s2sad.diagnostics import Report
from s2sad.infer.inference import Typing
from s2sad.infer.list_arrays import LISTED, MARKS, list_arrays, stored_list
from s2sad.naming import Names
from s2sad.normalize.calls.inline import Helpers
from s2sad.normalize.context import NormalContext
from s2sad.tree import (
    AST, Add, Assert, Assign, AugAssign, BinOp, BoolOp, Call, Compare, Constant, Div, Eq, FunctionDef, Gt, If, IfExp,
    List, Mult, Name, Not, NotEq, Slice, Store, Subscript, Tuple, UnaryOp, While, at, call, call_name, compare, const,
    copy, index, indices, name, rebuild, tuple_of, user_call, walk, walk_statements,
)

Levels = tuple[str, ...]        # what a value is, then what its items are, ...: "list", "tuple" or EITHER; () an array
EITHER = "either"
_WORDS = {"list": "a list", "tuple": "a tuple", EITHER: "a list or a tuple, or an array,"}
_HELP = "make an array of it where it is put into the list: np.array(...)"


def list_operators(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function without marks; the same one if it has none."""
    typing, helpers, report = context.typing, context.helpers, context.report
    if not any(call_name(n) in MARKS for n in walk(function.body)):
        return function
    return _ListOperators(function, typing, helpers, report, {}, ()).function()


def _join(a: Levels, b: Levels) -> Levels:
    """What a value is that is one of two."""
    for k, (x, y) in enumerate(zip((*a, ""), (*b, ""))):
        if x != y:
            return (*a[:k], EITHER)
    return a


class _ListOperators:
    """One function; `parameters` says what these are, `callers` the functions that led here."""

    def __init__(self, function: FunctionDef, typing: Typing, helpers: Helpers, report: Report,
                 parameters: dict[str, Levels], callers: tuple[str, ...]):
        self.tree, self.typing, self.helpers, self.report, self.callers = function, typing, helpers, report, callers
        self.changed = False
        self.table: dict[str, Levels] = {p.id: parameters.get(p.id, ()) for p in function.args.args}
        self.bound = {n.id for n in walk(function.body) if isinstance(n, Name) and isinstance(n.ctx, Store)}
        self.made = set(list_arrays(function))
        before: dict[str, Levels] | None = None
        while before != self.table:
            before = dict(self.table)
            for node in walk_statements(function.body):
                if isinstance(node, Assign):
                    self.note_binding(node.targets[0], node.value)

    def note_binding(self, target: AST, value: AST) -> None:
        """Takes note of what a statement binds, or puts into an array in place of a list."""
        found = self.of(value)
        if listed := stored_list(target, self.made):
            target, found = name(listed), None if found is None else ("list", *found)
        if isinstance(target, Name) and found is not None and call_name(value) != LISTED:
            self.table[target.id] = _join(self.table.get(target.id, found), found)

    def of(self, node: AST) -> Levels | None:
        """What a value is; None if that is not known yet."""
        if isinstance(node, Name):
            return self.table.get(node.id, None if node.id in self.bound else ())
        if isinstance(node, (List, Tuple)):
            inner = (self.of(node.elts[0]) if node.elts else ()) or ()
            return ("list" if isinstance(node, List) else "tuple", *inner)
        if isinstance(node, Subscript):
            return self.part(node)
        if isinstance(node, IfExp):
            either = self.of(node.body), self.of(node.orelse)
            return either[0] if either[1] is None else either[1] if either[0] is None else _join(either[0], either[1])
        if isinstance(node, BinOp):
            return self.of_operator(node, self.of(node.left), self.of(node.right))
        if call_name(node) == "numpy.copy" and isinstance(node, Call):     # or a list's own method
            found = self.of(node.args[0])
            return (EITHER,) if found else found
        if call_name(node) in MARKS and isinstance(node, Call):
            return (MARKS[call_name(node) or ""], *(self.of(node.args[0]) or ())[1:])
        passed = user_call(node) and any(map(self.of, node.args))
        return (EITHER,) if passed and self.typing.of(node).is_array else ()

    def of_operator(self, node: BinOp, left: Levels | None, right: Levels | None) -> Levels | None:
        if left is None or right is None:
            return None
        if isinstance(node.op, Add):
            return _join(left, right) if left and right else ()
        return self.repeated(node, left, right) or () if isinstance(node.op, Mult) else ()

    def part(self, node: Subscript) -> Levels | None:
        left, kept = self.of(node.value), []
        if not left:
            return left
        for subscript in indices(node):
            if self.typing.of(subscript).is_array or isinstance(subscript, Constant) and not isinstance(
                    subscript.value, int):
                return ()
            kept += left[:1] if isinstance(subscript, Slice) else []
            left = left[1:]
        return (*kept, *left)

    def repeated(self, node: BinOp, left: Levels | None, right: Levels | None) -> Levels | None:
        """What is repeated by a product, if one side is a list or a tuple and the other one an integer."""
        if left and self.typing.of(node.right).is_integer:
            return left
        return right if right and self.typing.of(node.left).is_integer else None

    # -- rewriting ---------------------------------------------------------------------------------------------------

    def function(self) -> FunctionDef:
        return rebuild(self.tree, self.change)

    def change(self, node: AST) -> AST | None:
        if isinstance(node, BinOp):
            return self.operator(node)
        if isinstance(node, Compare):
            return self.comparison(node)
        if isinstance(node, (If, IfExp, While, Assert)) and (test := self.truth(node.test)) is not None:
            new = copy(node)
            new.test = test
            return rebuild(new, self.change)
        if isinstance(node, UnaryOp) and isinstance(node.op, Not) and (test := self.truth(node.operand)) is not None:
            return at(UnaryOp(Not(), rebuild(test, self.change)), node)
        if isinstance(node, BoolOp):
            for value in node.values:
                self.refuse_if(value, node, "testing")
        if isinstance(node, (Assign, AugAssign)):
            self.refuse_float(node)
        if isinstance(node, AugAssign):
            self.refuse_augmented(node)
        if isinstance(node, Call):
            return self.called(node)
        return None

    def array(self, node: AST) -> AST:
        """A row as an array."""
        new = rebuild(node, self.change)
        return call("numpy.array", new) if isinstance(new, (List, Tuple)) else new

    def operator(self, node: BinOp) -> AST | None:
        left, right = self.of(node.left), self.of(node.right)
        if isinstance(node.op, Add) and left and right:
            if left[0] != right[0] or EITHER in (left[0], right[0]):
                self.refuse_if(node.right, node, "adding")
                return None
            return self.concatenated([node.left, node.right], node)
        if isinstance(node.op, Mult) and (found := self.repeated(node, left, right)):
            item, times = (node.left, node.right) if found is left else (node.right, node.left)
            count = times.value if isinstance(times, Constant) and type(times.value) is int else 0
            if count < 1 or found[0] == EITHER:
                self.refuse_if(item, node, "repeating no written number of times")
                return None
            return self.concatenated([item] * count, node)
        self.refuse_operands(node, left, right)
        return None

    def refuse_operands(self, node: BinOp, left: Levels | None, right: Levels | None) -> None:
        """Refuses an operator that Python does not have for a list or a tuple: beside an array it is NumPy's, and so is
        any but the product beside a number of NumPy's, which an expression may be."""
        lists = [side for side, found in ((node.left, left), (node.right, right)) if found and found[0] != EITHER]
        if len(lists) == 1:
            other = node.right if lists[0] is node.left else node.left
            is_number = self.of(other) == () and self.typing.of(other).is_number
            written = not any(isinstance(n, (Name, Call)) for n in walk(other))
            if not is_number or not isinstance(node.op, Mult) and not written:
                return
        if lists:
            self.refuse_if(lists[0], node, "Python has no such operator for", "make it an array with np.array")

    def concatenated(self, items: list[AST], node: AST) -> AST:
        self.changed = True
        return at(call("numpy.concatenate", tuple_of(*map(self.array, items))), node)

    def comparison(self, node: Compare) -> AST | None:
        sides = [node.left, *node.comparators]
        found = [self.of(side) for side in sides]
        if not any(found) or any(f == () and self.typing.of(s).is_array for f, s in zip(found, sides)):
            return None
        plain = len(sides) == 2 and isinstance(node.ops[0], (Eq, NotEq)) and found[0] and found[1]
        if not plain or found[0] != found[1] or EITHER in (*(found[0] or ()), *(found[1] or ())):
            self.refuse_if(next(s for s, f in zip(sides, found) if f), node, "comparing")
            return None
        self.changed = True
        equal = at(call("numpy.array_equal", *map(self.array, sides)), node)
        return equal if isinstance(node.ops[0], Eq) else at(UnaryOp(Not(), equal), node)

    def truth(self, test: AST) -> AST | None:
        """Whether a list or a tuple has items, where it is a test."""
        if isinstance(test, BoolOp):
            found = [self.truth(v) for v in test.values]
            return at(BoolOp(test.op, [f or v for f, v in zip(found, test.values)]), test) if any(found) else None
        if not (found := self.of(test)):
            return None
        if found[0] == EITHER:
            self.refuse_if(test, test, "testing")
            return None
        self.changed = True
        return at(compare(call("builtins.len", test), Gt(), const(0)), test)

    def refuse_augmented(self, node: AugAssign) -> None:
        target, value = self.of(node.target), self.of(node.value)
        longer = isinstance(node.op, Add) and target and (target[0] != "tuple" or value)
        more = isinstance(node.op, Mult) and target and self.typing.of(node.value).is_integer
        if longer or more:
            self.refuse_if(node.target, node, f"{'+' if longer else '*'}= on")

    def refuse_float(self, node: Assign | AugAssign) -> None:
        """Refuses a float in a list of integers, which is an array of integers."""
        target = node.targets[0] if isinstance(node, Assign) else node.target
        inexact = self.typing.of(node.value).is_inexact or isinstance(node, AugAssign) and isinstance(node.op, Div)
        if isinstance(target, Subscript) and inexact and not self.typing.of(target).is_inexact and not stored_list(
                target, self.made):
            self.refuse_if(target.value, node, "a float is put among the integers of", "start with floats: 0.0, not 0")

    def called(self, node: Call) -> AST | None:
        called = call_name(node) or ""
        if called in MARKS:
            return at(self.array_of(node.args[0]), node)
        passed = [self.of(a) or () for a in node.args]
        if called.startswith("user.") and any(passed) and self.depends_on_lists(node, passed):
            self.report.error("S201", f"'{called.removeprefix('user.')}' adds, repeats or compares what is a list or a "
                              "tuple that is an element of a list here", node, help=_HELP)
        return None

    def array_of(self, items: AST) -> AST:
        return call("numpy.array", rebuild(items, self.change))

    def depends_on_lists(self, node: Call, passed: list[Levels]) -> bool:
        """Whether a function uses an operator that is another one for lists and tuples than for arrays."""
        kernel = user_call(node) or ""
        source = self.helpers.program.kernels.get(kernel)
        if source is None or source.own is not None or kernel in self.callers:
            return source is not None and source.own is not None
        types = tuple(map(self.typing.argument, node.args))
        tree = self.helpers.tree(kernel, types)
        parameters = [p.id for p in tree.args.args]
        free = Names(n.id for n in walk(tree) if isinstance(n, Name))
        tree, typing = self.helpers.typing(tree, dict(zip(parameters, types)), source.source, free)
        inner = _ListOperators(tree, typing, self.helpers, Report(source.source), dict(zip(parameters, passed)),
                               (*self.callers, kernel))
        inner.function()
        return inner.changed or bool(inner.report.found)

    def refuse_if(self, value: AST, node: AST, what: str, help: str = _HELP) -> None:
        """Refuses a value that is, or may be, a list or a tuple."""
        if (found := self.of(value)) and self.is_whole(value):
            self.report.error("S201", f"{what} {_WORDS[found[0]]}", node, help="make it an array with np.array")
        elif found:
            self.report.error("S201", f"{what} {_WORDS[found[0]]} that is an element of a list", node, help=help)

    def is_whole(self, value: AST) -> bool:
        """Whether a value is all items of a list."""
        return isinstance(value, Call) and call_name(value) in MARKS and bool(
            stored_list(index(value.args[0], const(0)), self.made))
