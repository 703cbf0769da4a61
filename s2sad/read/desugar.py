"""desugar: spellings that mean no more than plainer ones take these, before the fence is asked.

    while (r := f(x)) > tol:        while True:
        ...                             r = f(x)
                                        if not r > tol:
                                            break
                                        ...
    raise ValueError(f"at {t:.3f}") raise ValueError("at {t:.3f}")
    raise ValueError("at %g" % t)   raise ValueError("'at %g' % t")
    print(f"{k}: {r:.2e}")          print(k, ":", r)
    print("r = %g" % r)             print("r = %g", r)
    with np.errstate(all="ignore"): y = x / z
        y = x / z
    del work                        pass
    for i in range(n)[::-1]:        for i in reversed(range(n)):        (ranges)
    if k in (1, m - 1):             if k == 1 or k == m - 1:
    k = list(range(n))              k = [item for item in range(n)]
    a, b, *_ = x                    a, b = x[0], x[1]           where nothing reads `_`
    a, *_ = f(x)                    a = f(x)[0]
    g(x) if c else h(x)             if c: g(x) else: h(x)       a statement that only calls
    t @= r                          t[...] = t @ r                      (multiplied)
    if k == 0: ... elif ...         branch = 0 ... if branch < 16: ...  (long_chains)
    a.shape = (n, n)                a = a.reshape((n, n))               where `a` is the only name (reshaped)

The text of an error is none that a derivative computes: it shows what stands between the braces. What NumPy warns of
is no matter of a derivative either. An assignment inside
an expression moves before its statement where nothing is evaluated before it but names and numbers; any other is left
for the fence to refuse, as are strings in any other place.
"""
from __future__ import annotations

from s2sad.read.elif_chains import elif_chains
from s2sad.read.matmul_assignment import matmul_assignment
from s2sad.read.range_values import ranged, unnamed
from s2sad.tree import (
    AST, Add, And, Assert, Assign, Attribute, BinOp, BoolOp, Break, Call, Compare, Constant, Eq, Expr, For,
    FunctionDef, If, IfExp, In, List, Load, Mod, Name, Not, NotEq, NotIn, Or, Pass, Raise, Return, Slice, Starred,
    Store, Subscript, Tuple, UnaryOp, While, at, children, const, copy, expr, index, name, rebuild, statements,
    tuple_of, walk, written,
)

_EXPRESSIONS = {Assign: "value", Expr: "value", Return: "value", If: "test", While: "test", For: "iter", Assert: "test"}
_BLOCKS = ("body", "orelse", "finalbody")
_LAZY = ("Lambda", "ListComp", "GeneratorExp", "SetComp", "DictComp")   # run later or not at all: nothing moves out


def desugar(function: FunctionDef) -> FunctionDef:
    """The function with such spellings in their plain form."""
    new = unnamed(elif_chains(copy(function)))
    read = {n.id for n in walk(function.body) if isinstance(n, Name) and not isinstance(n.ctx, Store)}

    bound = {n.id for n in walk(function) if isinstance(n, Name) and not isinstance(n.ctx, Load)}

    def change(node: AST) -> AST | None:
        if not bound & {"list", "range"} and (made := _listed(node)) is not None:
            return made
        return _unstarred(node, read) if isinstance(node, Assign) else _member(node)
    new.body = [rebuild(s, change) for s in new.body]
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


def _unstarred(node: Assign, read: set[str]) -> AST | None:
    """The targets one by one, where what the one with a star takes is not read."""
    target, value = node.targets[0], node.value
    if len(node.targets) > 1 or not isinstance(target, (Tuple, List)) or not isinstance(
            value, (Name, Attribute, Call)) or isinstance(value, Call) and len(target.elts) > 2:
        return None
    stars = [k for k, t in enumerate(target.elts) if isinstance(t, Starred)]
    if len(stars) != 1 or not isinstance(star := target.elts[stars[0]].value, Name) or star.id in read:
        return None
    others = [t for k, t in enumerate(target.elts) if k != stars[0]]
    places = [const(k if k < stars[0] else k - len(others)) for k in range(len(others))]
    items = [at(index(copy(value), place), value) for place in places]
    if not others:
        return at(Pass(), node)
    single = len(others) == 1
    return at(Assign([others[0] if single else at(Tuple(others, target.ctx), target)],
                     items[0] if single else at(tuple_of(*items), value), None), node)


def _member(node: AST) -> AST | None:
    """A question whether a name is one of several numbers or strings, as comparisons."""
    if not isinstance(node, Compare) or len(node.ops) != 1 or not isinstance(node.ops[0], (In, NotIn)):
        return None
    left, among = node.left, node.comparators[0]
    if not isinstance(among, (Tuple, List)) or not among.elts or not all(map(is_repeatable, [left, *among.elts])):
        return None
    op, joined = (Eq, Or) if isinstance(node.ops[0], In) else (NotEq, And)
    asked = [at(Compare(copy(left), [op()], [item]), node) for item in among.elts]
    return at(BoolOp(joined(), asked), node) if len(asked) > 1 else asked[0]


def is_repeatable(node: AST) -> bool:
    """Whether an expression may be computed several times, or not at all."""
    return all(isinstance(n, (Constant, Name, Subscript, Attribute, Tuple, BinOp, UnaryOp, Slice)) or not isinstance(
        n, expr) or isinstance(n, Call) and written(n.func) == "len" for n in walk(node))


def _blocks(node: AST) -> None:
    for field in _BLOCKS:
        block = getattr(node, field, None)
        if isinstance(block, list):
            setattr(node, field, [at(made, s) for s in block for made in _statement(s)])


def _statement(statement: AST) -> list[AST]:
    _blocks(statement)
    if _is_quieting(statement):
        return statement.body
    if type(statement).__name__ == "Delete" and all(isinstance(t, Name) for t in statement.targets):
        return [Pass()]
    if isinstance(statement, (Raise, Assert)):
        statement = _said(statement)
    if isinstance(statement, Expr) and isinstance(one := statement.value, IfExp):
        return _statement(at(If(one.test, [at(Expr(one.body), one)], [at(Expr(one.orelse), one)]), statement))
    if isinstance(statement, For):
        statement.iter = ranged(statement.iter)
    if isinstance(statement, Expr) and _is_print(statement.value):
        statement.value.args = [part for a in statement.value.args for part in _printed(a)]
    field = _EXPRESSIONS.get(type(statement))
    value = getattr(statement, field, None) if field else None
    if field is None or value is None or not any(map(_is_walrus, walk(value))):
        return [statement]
    return _moved(statement, field, value)


def _is_quieting(statement: AST) -> bool:
    """Whether a block only says what NumPy is to warn of: `with np.errstate(...)`."""
    return type(statement).__name__ == "With" and all(
        item.optional_vars is None and isinstance(item.context_expr, Call)
        and written(item.context_expr.func) in ("np.errstate", "numpy.errstate") for item in statement.items)


def _is_walrus(node: AST) -> bool:
    return type(node).__name__ == "NamedExpr"


def _is_print(node: AST) -> bool:
    return isinstance(node, Call) and isinstance(node.func, Name) and node.func.id == "print"


# -- assignments inside expressions ----------------------------------------------------------------------------------

def _moved(statement: AST, field: str, value: AST) -> list[AST]:
    """The statement with its inner assignments before it, as far as they can be moved."""
    before: list[AST] = []
    setattr(statement, field, _without(value, before))
    if not before:
        return [statement]
    if not isinstance(statement, While):
        return [*before, statement]
    if statement.orelse:
        setattr(statement, field, value)
        return [statement]
    test = at(If(UnaryOp(Not(), statement.test), [Break()], []), statement)
    return [While(const(True), [*(at(s, statement) for s in before), test, *statement.body], [])]


def _without(node: AST, before: list[AST]) -> AST:
    """The expression without the assignments that are evaluated before all else in it."""
    return rebuild(node, _First(before).change)


class _First:
    """Goes through an expression as Python evaluates it, until something stands in the way of a move."""

    def __init__(self, before: list[AST]):
        self.before = before
        self.read: set[str] = set()     # the names that were evaluated
        self.loads = self.stopped = False

    def change(self, node: AST) -> AST | None:
        inner = any(map(_is_walrus, walk(node)))
        if self.stopped or type(node).__name__ in _LAZY:
            self.stopped = self.stopped or inner
            return node
        if _is_walrus(node):
            return self.assigned(node)
        if isinstance(node, (BoolOp, IfExp)) and inner:     # what comes after the first part may not run
            made = copy(node)
            if isinstance(made, BoolOp):
                made.values[0] = rebuild(made.values[0], self.change)
            else:
                made.test = rebuild(made.test, self.change)
            self.stopped = True
            return made
        if isinstance(node, Call) and not inner:
            self.stopped = True     # it may write what a later assignment reads
            return node
        self.loads = self.loads or isinstance(node, (Subscript, Attribute)) and not inner
        self.read |= {node.id} if isinstance(node, Name) else set()
        return None

    def assigned(self, node: AST) -> AST:
        calls = any(isinstance(n, Call) for n in walk(node.value))
        if node.target.id in self.read or self.loads and calls:
            self.stopped = True
            return node
        value = rebuild(node.value, self.change)
        if any(map(_is_walrus, walk(value))):
            return node
        self.stopped = False
        self.before.append(at(Assign([node.target], value, None), node))
        return at(name(node.target.id), node)


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
