"""requested_dtypes: the dtype of an array that a function is to convert to becomes a constant.

    def f(x: "float64[:]", m: "int64[:]"):      def f(x, m):
        return np.sum(x * m.astype(x.dtype))        return np.sum(x * np.astype(m, dtype=np.float64))

Likewise

    np.linspace(a, b, 4, dtype=x.dtype)         np.astype(np.linspace(a, b, 4), dtype=np.float64)

Requires structured form, and types as far as they are known. Establishes that functions whose type depends on an
option `dtype` have a constant there. `np.linspace` with an integer dtype rounds down, where `astype` rounds to zero:
it stays.
"""
from __future__ import annotations

from s2sad.infer.promotion import dtype_of
from s2sad.normalize.context import NormalContext
from s2sad.rules import bound, find_array
from s2sad.tree import AST, Attribute, Call, FunctionDef, at, call, call_name, keyword, name, rebuild, with_body

_CONVERTING = ("numpy.astype", "numpy.arange", "numpy.eye", "numpy.tri", "numpy.identity", "numpy.linspace")
_KNOWN = {"bool": "numpy.bool_", **{d: f"numpy.{d}" for d in ("int32", "int64", "float32", "float64", "complex128")}}


def requested_dtypes(function: FunctionDef, context: NormalContext) -> FunctionDef:
    """The function with such constants; itself if there are none."""
    typing = context.typing
    found: list[AST] = []

    def constant_dtype(node: AST) -> AST:
        dtype = typing.of(node.value).dtype if isinstance(node, Attribute) and node.attr == "dtype" else ""
        if dtype not in _KNOWN:
            return rebuild(node, change)
        found.append(node)
        return at(name(_KNOWN[dtype]), node)

    def change(node: AST) -> AST | None:
        if not isinstance(node, Call) or call_name(node) not in _CONVERTING:
            return None
        keywords = [keyword(k.arg, constant_dtype(k.value)) for k in node.keywords]
        made = at(Call(node.func, [constant_dtype(a) for a in node.args], keywords), node)
        if call_name(node) == "numpy.linspace" and (cast := _cast(made)) is not None:
            found.append(node)
            return at(cast, node)
        return made
    new = with_body(function, [rebuild(statement, change) for statement in function.body])
    return new if found else function


def _cast(node: Call) -> AST | None:
    """`np.linspace` of floats with a dtype as a conversion."""
    requested = next((k.value for k in node.keywords if k.arg == "dtype"), None)
    kind = dtype_of(requested) if requested is not None else None
    rule = find_array("numpy.linspace")
    plain = rule and bound(rule, Call(node.func, node.args, [k for k in node.keywords if k.arg != "dtype"]))
    if plain is None or requested is None or kind not in ("float32", "float64"):
        return None
    made = call("numpy.astype", at(plain, node))
    made.keywords = [keyword("dtype", name(_KNOWN[kind]))]
    return made
