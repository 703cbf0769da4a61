"""The types of calls by those of their arguments: of kernels, of functions with rules, of allocations and casts."""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace

from s2sad import rules
from s2sad.infer.signatures.laws import LAWS
from s2sad.infer.scalar_reductions_types import reduced_number
from s2sad.infer.signatures.dispatch_by_name import expansion_type
from s2sad.infer.list_arrays import LISTED, MARKS
from s2sad.infer.promotion import CASTS, array_of_items, dtype_of, promote
from s2sad.infer.types import BOOL, FLOAT, INT, NONE, UNKNOWN, Type, array
from s2sad.rules.composed import LAW as COMPOSED
from s2sad.rules.rule import template
from s2sad.live_objects.registry import ROOM
from s2sad.tree import AST, Attribute, Call, Constant, List, Tuple, call_name, const, substitute


CallTypes = Callable[[str, tuple[Type, ...]], tuple[Type, ...]]

_ALLOCATIONS = {"numpy.empty", "numpy.zeros", "numpy.ones", "numpy.full"}
_LIKES = {"numpy.empty_like", "numpy.zeros_like", "numpy.ones_like", "numpy.full_like", "numpy.copy", "numpy.asarray",
          "numpy.ascontiguousarray", "numpy.array", *MARKS}
_ARRAYS = ("numpy.array", "numpy.asarray", "numpy.copy")
_REDUCED = ("numpy.argmax", "numpy.argmin", "numpy.count_nonzero", "numpy.any", "numpy.all")  # without an axis
_OF_ARGUMENTS = {"builtins.abs", "builtins.min", "builtins.max", "numpy.abs", "numpy.absolute", "numpy.minimum",
                 "numpy.maximum", "numpy.square", "numpy.conj", "numpy.conjugate", "numpy.real", "numpy.imag"}
_WIDENED = ("scipy.special.xlogy", "scipy.special.xlog1py")     # float64 of float32 with a number
_FLOATS = ("math.pow", "math.fmod", "numpy.float_power", "numpy.rint")    # of integers, too
_COMPARED = ("numpy.allclose", "numpy.array_equal")


class TypesOfCalls(ABC):
    """The types of calls; `inference.Typing` has those of their arguments."""
    call_types: CallTypes

    @abstractmethod
    def of(self, node: AST) -> Type: ...

    @abstractmethod
    def argument(self, node: AST) -> Type: ...

    def call_results(self, node: Call) -> tuple[Type, ...]:
        name = call_name(node)
        assert name is not None
        types = tuple(map(self.argument, node.args))
        return () if UNKNOWN in types else self.call_types(name.partition(".")[2], types)

    def _Call(self, node: Call) -> Type:
        name = call_name(node)
        if name is None:
            return self._method(node)
        if name.startswith("user."):
            results = self.call_results(node)
            plain = tuple(t.plain for t in results)
            return UNKNOWN if not plain else plain[0] if len(plain) == 1 else Type("tuple", items=plain)
        if name == LISTED:
            return UNKNOWN  # it follows from what is stored
        if name in _ALLOCATIONS:
            return self._allocation(name, node)
        if name in _LIKES:
            return self._like(name, node)
        types = [self.of(a) for a in node.args]
        if name.startswith(ROOM) and rules.constant_result(name):
            return {"float": FLOAT, "int": INT, "bool": BOOL}[rules.constant_result(name) or ""]
        rule = rules.find_array(name)
        if rule is not None and types and (rule.law == COMPOSED or types[0].kind != "tuple"):
            return self._array_function(rule, node, types)
        if name in CASTS:
            rank = types[0].rank if types else 0
            return array(CASTS[name], rank) if rank else Type("number", CASTS[name])
        if name == "builtins.sum" and types:
            return Type("number", "int64" if types[0].dtype == "bool" else types[0].dtype)
        if name in ("builtins.len", "numpy.size", "numpy.ndim"):
            return INT
        if name in ("numpy.shape",):
            return Type("tuple", items=(INT,) * types[0].rank) if types else UNKNOWN
        return self._function(name, types, bool(node.keywords))

    def _array_function(self, rule: rules.ArrayRule, node: Call, types: list[Type]) -> Type:
        if rule.name.startswith("runtime."):    # a rule's own text names no options
            types = types[:len(rule.operands)]
        if rule.name == "numpy.squeeze":
            types = list(map(self.argument, node.args))
        if any(t.kind == "unknown" for t in types) or len(types) != len(rule.operands):
            return UNKNOWN
        arguments = rule.arguments(node)
        if not arguments.keys() <= {*rule.operands, *rule.options}:
            return UNKNOWN
        if requested := self._inherited(arguments.get("dtype")):      # x.dtype
            arguments = {**arguments, "dtype": const(requested)}
        if len(types) == 1 and (of_number := reduced_number(rule.name, types[0], arguments)) != UNKNOWN:
            return of_number
        if rule.value:
            return self.of(substitute(template(rule.value), arguments))
        if rule.law == COMPOSED:
            return expansion_type(rule.name, [*types, *(self.of(arguments[o]) for o in rule.options)], arguments)
        return LAWS[rule.law].type(types, arguments)

    def _function(self, name: str, types: list[Type], keywords: bool) -> Type:
        if not types:
            return UNKNOWN
        if name == "numpy.where" and len(types) == 3:    # the condition has a part in the rank only
            chosen = promote(types[1], types[2])
            return Type("array", chosen.dtype, max(t.rank for t in types)) if types[0].is_array else chosen
        result = types[0]
        for other in types[1:]:
            result = promote(result, other)
        kind = rules.constant_result(name)
        if name in _WIDENED and any(t.is_number and t.dtype != "float32" for t in types):
            return Type(result.kind, "float64", result.rank)
        if name == "numpy.float_power" and result.dtype == "float32" or (
                name in _FLOATS and not result.is_inexact and result.dtype):
            return Type(result.kind, "float64", result.rank)
        if name == "builtins.round" and len(types) > 1:
            return types[0]
        if result.is_complex and (rule := rules.find(name)) is not None and rule.plane is not None:
            return result.real if rule.plane.kind == "gradient" else result
        if name in _COMPARED or name in _REDUCED and len(types) == 1 and not keywords:
            return INT if kind == "int" else BOOL
        if name == "numpy.searchsorted" and len(types) > 1 and types[1].is_number:
            return INT
        if kind in ("int", "bool"):
            return Type(result.kind, "int64" if kind == "int" else "bool", result.rank)
        rule = rules.find(name)
        if name in _OF_ARGUMENTS or kind == "same" or rule is not None and rule.result == "same":
            return result
        if result.kind == "unknown" or result.is_inexact:
            return result if not name.startswith("math.") or not result.dtype else Type(result.kind, "float64")
        return Type(result.kind, "float64", result.rank)

    def _method(self, node: Call) -> Type:
        if not isinstance(node.func, Attribute):
            return UNKNOWN
        base = self.of(node.func.value)
        if node.func.attr in ("copy", "conj", "conjugate"):
            return base
        if node.func.attr == "item" and len(node.args) < 2 and not node.keywords and (
                base.is_array or base.is_number):
            return Type("number", base.dtype)
        return UNKNOWN if node.func.attr != "fill" else NONE

    def _dtype(self, node: Call, position: int, default: str) -> str:
        dtype = next((k.value for k in node.keywords if k.arg == "dtype"), None)
        if dtype is None and len(node.args) > position:
            dtype = node.args[position]
        if dtype is None or isinstance(dtype, Constant) and dtype.value is None:
            return default
        return dtype_of(dtype) or self._inherited(dtype) or ""

    def _inherited(self, node: AST | None) -> str | None:
        if isinstance(node, Attribute) and node.attr == "dtype":
            return self.of(node.value).dtype
        return None

    def _allocation(self, name: str, node: Call) -> Type:
        if not node.args:
            return UNKNOWN
        shape = node.args[0]
        kind = self.of(shape)
        rank = len(shape.elts) if isinstance(shape, (Tuple, List)) else len(kind.items) if kind.kind == "tuple" else 1
        if kind.kind == "unknown":
            return UNKNOWN
        if name == "numpy.full":
            return _array(self._dtype(node, 2, self.of(node.args[1]).dtype), rank)
        return _array(self._dtype(node, 1, "float64"), rank)

    def _like(self, name: str, node: Call) -> Type:
        base = self.of(node.args[0])
        if base.kind == "tuple":
            joined = array_of_items(base)
            return _array(self._dtype(node, 1, joined.dtype), joined.rank) if joined.dtype else UNKNOWN
        if base.is_number and name in _ARRAYS and {k.arg for k in node.keywords} <= {"dtype", "order"}:
            dtype = self._dtype(node, 1, base.dtype)    # without axes: a number of NumPy's
            return replace(base, dtype=dtype) if dtype in CASTS.values() else UNKNOWN
        if not base.is_array:
            return UNKNOWN
        return _array(self._dtype(node, 2 if name == "numpy.full_like" else 1, base.dtype), base.rank)


def _array(dtype: str, rank: int) -> Type:
    """An array's type; a dtype that kernels do not have is none."""
    return array(dtype, rank) if dtype else UNKNOWN
