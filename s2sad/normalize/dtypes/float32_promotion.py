"""float32_promotion: where NumPy computes with float64, as a float32 array meets what has a wider dtype, the array
is made so.

    s = a + p[0]                    s = np.float64(a) + p[0]                a: float32, p: float64
    s = a * k                       s = np.float64(a) * k                   k: int64
    s = np.append(a, 2.0)           s = np.append(np.float64(a), 2.0)
    w = np.array([a[0], 2])         w = np.array([a[0], 2], dtype=np.float64)
    w = np.linspace(a[0], a[1], 4)  w = np.linspace(a[0], a[1], 4).astype(np.float32)

Requires structured form and types (infer/weak_types.py says which numbers have a dtype); establishes that the types
of its expressions are NumPy's. A store into a float32 array rounds, whatever is stored.
"""
from __future__ import annotations

from collections.abc import Mapping

from s2sad import rules
from s2sad.infer.inference import Typing
from s2sad.infer.promotion import dtype_of
from s2sad.infer.signatures.laws import items_of
from s2sad.infer.weak_types import Results, StrongDtypes, promoted_dtype
from s2sad.tree import (
    AST, BinOp, Call, Constant, FunctionDef, List, Name, Tuple, at, call, call_name, copy, keyword, name, rebuild, walk,
)

_LISTS = {f"numpy.{f}" for f in ("concatenate", "stack", "hstack", "vstack", "column_stack", "dstack", "append", "r_")}
_OPERANDS = {
    **{f"numpy.{f}": (0, 1) for f in ("matmul", "dot", "vdot", "inner", "outer", "tensordot", "kron", "cross",
                                      "convolve", "correlate", "trapezoid", "polyval", "linalg.solve")},
    **{f"numpy.{f}.outer": (0, 1) for f in ("add", "subtract", "multiply", "divide", "power", "maximum", "minimum",
                                            "hypot", "logaddexp", "arctan2")},
    "numpy.where": (1, 2), "numpy.einsum": range(1, 32)}


def float32_promotion(function: FunctionDef, typing: Typing, results: Results) -> FunctionDef | None:
    """The function with such conversions, None if it needs none."""
    if not has_singles(function, typing):
        return None
    pass_ = _Promotion(typing, StrongDtypes(function, typing, results))
    made = rebuild(function, pass_.change)
    return made if pass_.found else None


def has_singles(function: FunctionDef, typing: Typing) -> bool:
    """Whether a function has float32 anywhere."""
    return any(t.dtype == "float32" for t in typing.table.values()) or makes_singles(function)


def makes_singles(function: FunctionDef) -> bool:
    """Whether the text of a function names float32."""
    return any(isinstance(n, Name) and dtype_of(n) == "float32" or isinstance(n, Constant) and n.value in (
        "float32", "f4", "f", "single") for n in walk(function.body))


def mixtures(function: FunctionDef, typing: Typing, results: Results, given: Mapping[str, str]) -> int:
    """How many expressions of a function would change where its parameters are given such numbers of NumPy's."""
    pass_ = _Promotion(typing, StrongDtypes(function, typing, results, given))
    rebuild(function, pass_.change)
    return len(pass_.found)


class _Promotion:
    """The pass over one function; `found` are the expressions that were changed."""

    def __init__(self, typing: Typing, strong: StrongDtypes):
        self.typing, self.strong = typing, strong
        self.found: list[AST] = []

    def change(self, node: AST) -> AST | None:
        if isinstance(node, BinOp) and self.is_wider(node, [node.left, node.right]):
            return self.replaced(node, BinOp(self.wide(node.left), node.op, self.wide(node.right)))
        called = call_name(node)
        if called is None or not isinstance(node, Call):
            return None
        if called == "numpy.astype" and call_name(node.args[0]) == "numpy.linspace":
            return node     # it has been made so
        if called == "numpy.array" and len(node.args) == 1 and not node.keywords:
            return self.spelled_out(node)
        if called == "numpy.linspace" and self.strong.of_operands(node.args[:2]) == "float32":
            return self.replaced(node, call("numpy.astype", copy(node), dtype=name("numpy.float32")))
        places = self.places(called, node)
        return self.promoted_dtype(node, places, called in _LISTS) if places else None

    def promoted_dtype(self, node: Call, places: list[int], listed: bool) -> AST | None:
        """A call whose operands have one dtype for NumPy."""
        given = [item for k in places for item in items_of(node.args[k])]
        if not self.is_wider(node, given, listed):
            return None
        made = copy(node)
        made.args = [self.wide(a) if k in places else rebuild(a, self.change) for k, a in enumerate(node.args)]
        made.keywords = [at(keyword(k.arg, rebuild(k.value, self.change)), node) for k in node.keywords]
        return self.replaced(node, made)

    def places(self, called: str, node: Call) -> list[int]:
        """The arguments of a call that NumPy makes one dtype of."""
        if called in _LISTS:
            return [0, 1] if called == "numpy.append" else [0]
        known = _OPERANDS.get(called)
        if known is None:
            rule = rules.find(called)
            several = (rule is not None and len(rule.parameters) > 1 or rules.constant_result(called) == "same")
            known = range(8) if called.startswith(("numpy.", "scipy.")) and several else ()
        return [k for k in known if k < len(node.args)]

    def is_wider(self, node: AST, operands: list[AST], listed: bool = False) -> bool:
        """Whether NumPy makes float64 of these operands, though one is an array of float32 and the type of the whole
        is not that; `listed` numbers have a dtype."""
        if self.typing.of(node).dtype == "float64" or not any(map(self.is_single, operands)):
            return False
        return promoted_dtype(list(map(self.strong.item if listed else self.strong.of, operands))) == "float64"

    def is_single(self, node: AST) -> bool:
        kind = self.typing.of(node)
        return kind.is_array and kind.dtype == "float32"

    def wide(self, node: AST) -> AST:
        """An operand, of float64 if it is an array of float32; an array in a list as well."""
        if isinstance(node, (Tuple, List)):
            return at(type(node)(list(map(self.wide, node.elts)), node.ctx), node)
        count = len(self.found)
        inner = rebuild(node, self.change)
        same = len(self.found) == count     # else its type is another one now, and the next round sees it
        return at(call("numpy.float64", inner), node) if same and self.is_single(node) else inner

    def spelled_out(self, node: Call) -> AST | None:
        """An array that is spelled out, with its dtype where that is not the widest of its items'."""
        if self.typing.of(node).dtype != "float32" or self.strong.item(node.args[0]) != "float64" or not isinstance(
                node.args[0], (List, Tuple)):
            return None
        made = call("numpy.array", rebuild(node.args[0], self.change), dtype=name("numpy.float64"))
        return self.replaced(node, made)

    def replaced(self, old: AST, new: AST) -> AST:
        self.found.append(old)
        return at(new, old) if getattr(old, "lineno", None) else new
