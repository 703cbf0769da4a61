"""desugar: spellings that mean no more than plainer ones take these, before the fence is asked.

    raise ValueError(f"at {t:.3f}") raise ValueError("at {t:.3f}")
    raise ValueError("at %g" % t)   raise ValueError("'at %g' % t")
    print(f"{k}: {r:.2e}")          print(k, ":", r)
    print("r = %g" % r)             print("r = %g", r)
    for i in range(n)[::-1]:        for i in reversed(range(n)):        (ranges)
    k = list(range(n))              k = [item for item in range(n)]
    g(x) if c else h(x)             if c: g(x) else: h(x)       a statement that only calls
    t @= r                          t[...] = t @ r                      (multiplied)
    if k == 0: ... elif ...         branch = 0 ... if branch < 16: ...  (long_chains)
    a.shape = (n, n)                a = a.reshape((n, n))               where `a` is the only name (reshaped)

The text of an error is none that a derivative computes: it shows what stands between the braces. Strings in any other
place are left for the fence to refuse.
"""
from __future__ import annotations

from s2sad.read.elif_chains import elif_chains
from s2sad.read.matmul_assignment import matmul_assignment
from s2sad.read.range_values import ranged, unnamed
from s2sad.tree import (
    AST, Add, Assert, Attribute, BinOp, Call, Constant, Expr, For,
    FunctionDef, If, IfExp, Load, Mod, Name, Raise, Tuple, at, children, const, copy, rebuild, statements,
    walk, written,
)

_BLOCKS = ("body", "orelse", "finalbody")


def desugar(function: FunctionDef) -> FunctionDef:
    """The function with such spellings in their plain form."""
    new = unnamed(elif_chains(copy(function)))
    bound = {n.id for n in walk(function) if isinstance(n, Name) and not isinstance(n.ctx, Load)}

    if not bound & {"list", "range"}:
        new.body = [rebuild(s, _listed) for s in new.body]
    new = matmul_assignment(new)
    _blocks(new)
    return new


def _listed(node: AST) -> AST | None:
    """A list of a range."""
    if not isinstance(node, Call) or written(node.func) != "list" or len(node.args) != 1 or node.keywords or not (
            isinstance(node.args[0], Call) and written(node.args[0].func) == "range"):
        return None
    [made] = statements("[item for item in range(0)]")
    made.value.generators[0].iter = node.args[0]
    return at(made.value, node)


def _blocks(node: AST) -> None:
    for field in _BLOCKS:
        block = getattr(node, field, None)
        if isinstance(block, list):
            setattr(node, field, [at(made, s) for s in block for made in _statement(s)])


def _statement(statement: AST) -> list[AST]:
    _blocks(statement)
    if isinstance(statement, (Raise, Assert)):
        statement = _said(statement)
    if isinstance(statement, Expr) and isinstance(one := statement.value, IfExp):
        return _statement(at(If(one.test, [at(Expr(one.body), one)], [at(Expr(one.orelse), one)]), statement))
    if isinstance(statement, For):
        statement.iter = ranged(statement.iter)
    if isinstance(statement, Expr) and _is_print(statement.value):
        statement.value.args = [part for a in statement.value.args for part in _printed(a)]
    return [statement]


def _is_print(node: AST) -> bool:
    return isinstance(node, Call) and isinstance(node.func, Name) and node.func.id == "print"


# -- texts -----------------------------------------------------------------------------------------------------------

def _said(statement: AST) -> AST:
    """The statement with the texts of its message as plain strings."""
    parts = [statement.msg] if isinstance(statement, Assert) else [statement.exc, statement.cause]

    def change(n: AST) -> AST | None:
        if any(n is p for p in children(statement)) and not any(n is p for p in parts):
            return n
        if type(n).__name__ == "JoinedStr":
            return at(const(_template(n)), n)
        return at(const(written(n)), n) if _is_text(n) else None
    return rebuild(statement, change)


def _is_text(node: AST) -> bool:
    """Whether an expression makes a string: of one that is written, or of a value."""
    if isinstance(node, BinOp) and isinstance(node.op, (Add, Mod)):
        return any(_is_text(n) or _is_string(n) for n in (node.left, node.right))
    if not isinstance(node, Call):
        return False
    made = isinstance(node.func, Name) and node.func.id in ("str", "repr")
    return made or isinstance(node.func, Attribute) and _is_string(node.func.value)


def _is_string(node: AST) -> bool:
    return type(node).__name__ == "JoinedStr" or isinstance(node, Constant) and isinstance(node.value, str)


def _template(node: AST) -> str:
    """An f-string's text with its expressions between braces, as they are written."""
    found = ""
    for part in node.values:
        if isinstance(part, Constant):
            found += part.value
        else:
            form = ":" + _template(part.format_spec) if part.format_spec is not None else ""
            found += "{" + written(part.value) + form + "}"
    return found


def _printed(node: AST) -> list[AST]:
    """What print is given, an f-string and other texts in their parts."""
    if _is_text(node):
        parts = [node.left, node.right] if isinstance(node, BinOp) else [*node.args, *(k.value for k in node.keywords)]
        if isinstance(node, Call) and isinstance(node.func, Attribute):
            parts = [node.func.value, *parts]
        return [p for part in parts for q in (part.elts if isinstance(part, Tuple) else [part]) for p in _printed(q)]
    if type(node).__name__ != "JoinedStr":
        return [node]
    parts = [at(const(p.value.strip()), p) if isinstance(p, Constant) else p.value for p in node.values]
    return [p for p in parts if not (isinstance(p, Constant) and p.value == "")]
