"""What pyright knows of gast, which makes its node classes when it is imported.

A node has any attribute, and may stand where a node of one class is asked for: what class it is the compiler often
knows from the name that a call calls, which pyright cannot follow. Fields that hold texts or lists are declared.
"""
import ast
from collections.abc import Iterator
from typing import Any, TypeVar

class AST(Any):
    _fields: tuple[str, ...]
    lineno: int
    col_offset: int
    end_lineno: int | None
    end_col_offset: int | None
    def __init__(self, *fields: Any, **named: Any) -> None: ...
    def __getattr__(self, name: str) -> Any: ...

class mod(AST): ...
class stmt(AST): ...
class expr(AST): ...
class expr_context(AST): ...
class operator(AST): ...
class unaryop(AST): ...
class boolop(AST): ...
class cmpop(AST): ...

class Module(mod):
    body: list[Any]

class FunctionDef(stmt):
    name: str
    args: arguments
    body: list[Any]
    decorator_list: list[Any]

class arguments(AST):
    args: list[Name]
    posonlyargs: list[Name]
    vararg: Any
    kwonlyargs: list[Name]
    kw_defaults: list[Any]
    kwarg: Any
    defaults: list[Any]

class keyword(AST):
    arg: str | None
    value: AST

class Assign(stmt):
    targets: list[Any]
    value: AST

class AugAssign(stmt):
    target: AST
    op: AST
    value: AST

class AnnAssign(stmt):
    target: AST
    annotation: AST
    value: Any

class For(stmt):
    target: AST
    iter: AST
    body: list[Any]
    orelse: list[Any]

class While(stmt):
    test: AST
    body: list[Any]
    orelse: list[Any]

class If(stmt):
    test: AST
    body: list[Any]
    orelse: list[Any]

class Expr(stmt):
    value: AST

class Return(stmt):
    value: Any

class Assert(stmt):
    test: AST
    msg: Any

class Raise(stmt):
    exc: Any
    cause: Any

class Break(stmt): ...
class Continue(stmt): ...
class Pass(stmt): ...

class Name(expr):
    id: str
    ctx: AST
    annotation: Any

class Constant(expr):
    value: Any
    kind: str | None

class Dict(expr):
    keys: list[Any]
    values: list[Any]

class Call(expr):
    func: AST
    args: list[Any]
    keywords: list[keyword]

class Attribute(expr):
    value: AST
    attr: str
    ctx: AST

class Subscript(expr):
    value: AST
    slice: AST
    ctx: AST

class Slice(expr):
    lower: Any
    upper: Any
    step: Any

class Tuple(expr):
    elts: list[Any]
    ctx: AST

class List(expr):
    elts: list[Any]
    ctx: AST

class Starred(expr):
    value: AST
    ctx: AST

class BinOp(expr):
    left: AST
    op: AST
    right: AST

class UnaryOp(expr):
    op: AST
    operand: AST

class BoolOp(expr):
    op: AST
    values: list[Any]

class Compare(expr):
    left: AST
    ops: list[Any]
    comparators: list[Any]

class IfExp(expr):
    test: AST
    body: AST
    orelse: AST

class ListComp(expr):
    elt: AST
    generators: list[Any]
class DictComp(expr):
    key: AST
    value: AST
    generators: list[Any]

class GeneratorExp(expr):
    elt: AST
    generators: list[Any]

class Yield(expr):
    value: Any

class Load(expr_context): ...
class Store(expr_context): ...
class Param(expr_context): ...
class Add(operator): ...
class Sub(operator): ...
class Mult(operator): ...
class MatMult(operator): ...
class Div(operator): ...
class FloorDiv(operator): ...
class Mod(operator): ...
class Pow(operator): ...
class LShift(operator): ...
class RShift(operator): ...
class BitAnd(operator): ...
class BitOr(operator): ...
class BitXor(operator): ...
class Invert(unaryop): ...
class Not(unaryop): ...
class UAdd(unaryop): ...
class USub(unaryop): ...
class And(boolop): ...
class Or(boolop): ...
class Eq(cmpop): ...
class NotEq(cmpop): ...
class Lt(cmpop): ...
class LtE(cmpop): ...
class Gt(cmpop): ...
class GtE(cmpop): ...
class Is(cmpop): ...
class IsNot(cmpop): ...
class In(cmpop): ...
class NotIn(cmpop): ...

_Node = TypeVar("_Node", bound=AST)

def ast_to_gast(node: ast.AST) -> Module: ...
def gast_to_ast(node: AST) -> ast.Module: ...
def copy_location(new_node: _Node, old_node: AST) -> _Node: ...
def iter_child_nodes(node: AST) -> Iterator[AST]: ...
def walk(node: AST) -> Iterator[AST]: ...
