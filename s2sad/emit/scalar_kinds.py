"""scalar_kinds: whether a value is a number of Python's or of NumPy's when CPython runs the text.

Elements of arrays are NumPy's, what `np.` functions give is, and what arithmetic makes of one of these and anything.
Literals, parameters, results of `len` are Python's. A name is Python's if one of its bindings may be.
"""
from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from s2sad.diagnostics import Report, Source
from s2sad.infer.inference import Typing
from s2sad.infer.types import Type
from s2sad.rules import constant_result
from s2sad.tree import (
    AST, AnnAssign, Assign, AugAssign, BinOp, BoolOp, Call, Compare, Constant, Div, FloorDiv, For, FunctionDef, IfExp,
    List, Mod, Name, Pow, Return, Subscript, Tuple, USub, UnaryOp, call_name, name, stored_names, walk, walk_statements,
)

# of a name that is bound to several it is the last of them that counts
NUMPY, NARROW, INT, FLOAT = range(4)  # NARROW: NumPy's, of less than 64 bits
CHOICES = ("builtins.min", "builtins.max", "builtins.abs")
CONVERT = "numpy.float64"
_WIDE = ("float64", "int64", "int32", "uint64", "uint32")
_LENGTHS = ("numpy.size", "numpy.ndim", "numpy.shape", "builtins.len", "builtins.int", "builtins.round",
            "builtins.bool")
_INTEGERS = ("floor", "ceil", "trunc", "isqrt", "comb", "perm", "factorial", "gcd", "lcm")
_RUNTIME = ("runtime.grow", "runtime.sized", "runtime.blocked_sum", "runtime.pairwise_sum")

# `math`'s functions of floats as NumPy has them; those that are left (erf, isnan, ...) raise nowhere
_SAME = ("sqrt", "cbrt", "exp", "exp2", "expm1", "log", "log2", "log10", "log1p", "sin", "cos", "tan", "sinh", "cosh",
         "tanh", "hypot", "copysign", "fabs", "fmod", "degrees", "radians")
_OTHERS = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2", "asinh": "arcsinh",
           "acosh": "arccosh", "atanh": "arctanh", "pow": "float_power"}
OF_MATH = {**{f"math.{n}": f"numpy.{n}" for n in _SAME}, **{f"math.{m}": f"numpy.{n}" for m, n in _OTHERS.items()},
           "math.remainder": "runtime.remainder"}


class ScalarKinds:
    """The kinds of the values of one function, in which `converted` names are NumPy's where a parameter or a literal
    binds them.

    `types` has its parameters and arrays, `constants` the values behind `const.` names, `known` the kinds of its
    arguments if only the module's functions call it, `results` those of the results of functions that it calls.
    `math`, and what would raise, gives numbers of NumPy's, for it is replaced; of Python's where the text is taken
    `as_it_is`.
    """

    def __init__(self, tree: FunctionDef, types: Mapping[str, Type], constants: Mapping[str, object],
                 known: list[int], results: Mapping[str, list[int]], as_it_is: bool = False):
        self.tree, self.types, self.constants, self.as_it_is = tree, types, constants, as_it_is
        self.typing = Typing(types, lambda kernel, types: (), Report(Source("", "")), constants)
        self.complex = any(t.is_complex for t in types.values()) or any(
            isinstance(n, Constant) and isinstance(n.value, complex) for n in walk(tree.body))
        if self.complex:
            self.typing = self.typing.extended(tree.body)
        self.results = {} if as_it_is else results
        self.parameters = [p.id for p in tree.args.args]
        self.known = dict(zip(self.parameters, known))
        self.bound: dict[str, list[AST | int]] = {}
        for statement in walk(tree.body):
            self._bind(statement)
        self.converted: set[str] = set()
        self.kinds: dict[str, int] = {}
        self._known: dict[AST, int] = {}        # the kinds of expressions, by identity
        self.find()

    def _bind(self, statement: AST) -> None:
        """Enters what a statement binds: expressions, or a kind where the text of the binding cannot be changed."""
        if isinstance(statement, Assign):
            alone = len(statement.targets) == 1 and isinstance(statement.targets[0], Name)
            for target in statement.targets:
                self._bind_to(target, statement.value, alone)
        elif isinstance(statement, AugAssign) and isinstance(statement.target, Name):
            value = BinOp(name(statement.target.id), statement.op, statement.value)
            self._bind_to(statement.target, value, True)
        elif isinstance(statement, AnnAssign) and statement.value is not None:
            self._bind_to(statement.target, statement.value, False)

    def _bind_to(self, target: AST, value: AST, alone: bool) -> None:
        if isinstance(target, Name):
            literal = isinstance(value, Constant) and not alone
            self.bound.setdefault(target.id, []).append(self.kind(value) if literal else value)
        elif isinstance(target, (Tuple, List)):
            kinds = self.results.get((call_name(value) or "").partition(".")[2], [])
            shown = isinstance(value, (Tuple, List)) and len(value.elts) == len(target.elts)
            for place, part in enumerate(target.elts):
                if shown:
                    self._bind_to(part, value.elts[place], False)
                else:
                    for inner in stored_names(part):
                        self.bound.setdefault(inner, []).append(
                            kinds[place] if place < len(kinds) else self._by_type(inner))

    def _by_type(self, identifier: str) -> int:
        """What a number may be of which its type alone is known: an integer is no float."""
        kind = self.types.get(identifier)
        return INT if kind is not None and kind.is_number and not kind.is_float and not kind.is_complex else FLOAT

    def find(self) -> None:
        """The kinds of the names, from the least."""
        self._known = {}
        self.kinds = {p: self.of_parameter(p) for p in self.parameters}
        for loop in (s for s in walk_statements(self.tree.body) if isinstance(s, For)):
            kind = INT if call_name(loop.iter) == "builtins.range" else FLOAT
            self.kinds |= dict.fromkeys(stored_names(loop.target), kind)
        changed = True
        while changed:
            changed = False
            for key, values in self.bound.items():
                for value in values:
                    kind = self.of_binding(key, value)
                    if kind > self.kinds.get(key, -1):
                        self.kinds[key], changed, self._known = kind, True, {}

    def of_parameter(self, parameter: str) -> int:
        kind = self.types.get(parameter)
        if kind is None or not kind.is_number:
            return NUMPY
        if kind.is_complex:     # one that is given is NumPy's (`binding`)
            return self.known.get(parameter, NUMPY)
        if kind.dtype != "float64":
            return NARROW if kind.is_float else INT
        return NUMPY if parameter in self.converted else self.known.get(parameter, FLOAT)

    def returned(self) -> list[int]:
        """The kinds of the function's results."""
        values = [s.value for s in walk_statements(self.tree.body) if isinstance(s, Return)]
        rows = [list(map(self.kind, v.elts)) if isinstance(v, Tuple) else [self.kind(v)] for v in values if v]
        return [max(kinds) for kinds in zip(*rows)]

    def of_binding(self, key: str, value: AST | int) -> int:
        if isinstance(value, int):
            return value
        return NUMPY if key in self.converted and isinstance(value, Constant) else self.kind(value)

    def kind(self, node: AST) -> int:
        """Whose number an expression gives; of names without a binding so far the least."""
        if isinstance(node, Constant):
            return NARROW if isinstance(node.value, np.generic) else (
                FLOAT if isinstance(node.value, (float, complex)) else INT)
        if isinstance(node, Name):
            return self.of_name(node.id)
        if node not in self._known:
            self._known[node] = self._kind(node)
        return self._known[node]

    def _kind(self, node: AST) -> int:
        if isinstance(node, Subscript):
            if not isinstance(node.value, Name):
                return INT  # x.shape[0]
            kind = self.types.get(node.value.id)
            return NUMPY if kind is None or kind.dtype in _WIDE else NARROW
        if isinstance(node, BinOp):
            left, right = self.kind(node.left), self.kind(node.right)
            if not self.as_it_is and self._raises(node, left, right):
                return NUMPY  # for an operand is converted
            if self.is_complex(node):
                return self.of_complex(node, left, right)
            return self.of_operands(left, right, isinstance(node.op, Div))
        if isinstance(node, UnaryOp):
            return INT if type(node.op).__name__ == "Not" else self.kind(node.operand)
        if isinstance(node, (Compare, BoolOp)):
            parts = [node.left, *node.comparators] if isinstance(node, Compare) else node.values
            return NUMPY if min(map(self.kind, parts)) <= NARROW else INT
        if isinstance(node, IfExp):
            return max(self.kind(node.body), self.kind(node.orelse))
        return self.of_call(node) if isinstance(node, Call) else INT

    def is_complex(self, node: AST) -> bool:
        return self.complex and self.typing.of(node).is_complex

    def of_complex(self, node: BinOp, left: int, right: int) -> int:
        """Whose number an operation gives: Python's complex numbers take floats of NumPy's for Python's."""
        return NUMPY if left <= NARROW or right <= NARROW and self.is_complex(node.right) else FLOAT

    def of_name(self, identifier: str) -> int:
        if identifier.startswith("const."):
            value = self.constants.get(identifier.partition(".")[2])
            narrow = isinstance(value, np.floating) and not isinstance(value, float)
            return INT if isinstance(value, (int, np.integer)) else NARROW if narrow else FLOAT
        if "." in identifier:
            return FLOAT  # numpy.pi
        return self.kinds.get(identifier, NUMPY)

    def of_operands(self, left: int, right: int, divides: bool) -> int:
        if min(left, right) <= NARROW:
            return NARROW if NARROW in (left, right) and NUMPY not in (left, right) else NUMPY
        return FLOAT if divides else max(left, right)

    def of_call(self, node: Call) -> int:
        called = call_name(node) or ""
        if called in _LENGTHS:
            return INT
        if called in (*CHOICES, "numpy.real", "numpy.imag") and node.args:
            return max(map(self.kind, node.args))
        if called in OF_MATH:
            return FLOAT if self.as_it_is else NUMPY
        if called.startswith(("numpy.", "scipy.")):
            kinds = list(map(self.kind, node.args))
            return NARROW if called == "numpy.float32" or NARROW in kinds and NUMPY not in kinds and \
                called != CONVERT else NUMPY
        module, _, function = called.partition(".")
        if constant_result(called) in ("int", "bool"):
            return INT
        if module == "user":
            return max(self.results.get(function, [FLOAT]))
        return NUMPY if called in _RUNTIME else INT if function in _INTEGERS else FLOAT

    def raises(self, node: AST) -> bool:
        """Whether an operation on Python's numbers may raise where NumPy's do not."""
        return isinstance(node, BinOp) and self._raises(node, self.kind(node.left), self.kind(node.right))

    def _raises(self, node: BinOp, left: int, right: int) -> bool:
        if self.is_complex(node):
            value = self.number(node.right)
            safe = value is not None and (value >= 0 if isinstance(node.op, Pow) else value != 0)
            return isinstance(node.op, (Div, Pow)) and not safe and self.of_complex(node, left, right) == FLOAT
        if min(left, right) <= NARROW or not isinstance(node.op, (Div, Mod, FloorDiv, Pow)) or (
                isinstance(node.left, Constant) and isinstance(node.right, Constant)):
            return False
        value = self.number(node.right)
        if isinstance(node.op, Pow):
            return FLOAT in (left, right) or value is not None and value < 0
        return (isinstance(node.op, Div) or FLOAT in (left, right)) and not value

    def number(self, node: AST) -> float | None:
        """The value of a constant."""
        if isinstance(node, UnaryOp) and isinstance(node.op, USub):
            value = self.number(node.operand)
            return None if value is None else -value
        value = getattr(node, "value", None) if isinstance(node, Constant) else None
        if isinstance(node, Name):
            module, _, rest = node.id.partition(".")
            value = self.constants.get(rest) if module == "const" else getattr(np, rest, None) if rest else None
        return value if isinstance(value, (int, float)) and not isinstance(value, bool) else None
