"""scipy_solvers: the factorizations and solvers of `scipy.linalg`, in the functions that have rules here.

    def f(a: "float64[:, :]", b: "float64[:]"):             def f(a, b):
        factors = scipy.linalg.lu_factor(a)                     factors = factored(a)
        return np.sum(scipy.linalg.lu_solve(factors, b))        return np.sum(solved(factors, b))

Requires structured form, and calls as `scipy_linalg` leaves them. Establishes that what is left of `scipy.linalg` has a
rule; anything else is refused here. A factorization is for the solvers: elsewhere SciPy's holds entries that mean
nothing. Of Cholesky's what lies in its own triangle may be read, too: `np.diag(c)`, `c[i, i]`, `np.triu(c)`.
"""
from __future__ import annotations

from dataclasses import dataclass

from s2sad import rules
from s2sad.diagnostics import Report
from s2sad.normalize.library.scipy_linalg import IGNORED, SCIPY, transposed_matrices
from s2sad.passes import Context
from s2sad.rules.spellings import TABLE
from s2sad.tree import (
    AST, Assign, Attribute, Call, Constant, FunctionDef, List, Name, Store, Subscript, Tuple, at, call, call_name,
    const, copy, dump, keyword, rebuild, walk, walk_statements, with_body,
)

_FACTORS, _SOLVES = ("lu_factor", "cho_factor"), ("lu_solve", "cho_solve")
_TRIANGLES = {"numpy.diag": None, "numpy.diagonal": None, "numpy.tril": True, "numpy.triu": False}
_TRANS = {"N": 0, "T": 1, "C": 1, 2: 1}
_HELP = {
    "eigh": "write w, v = np.linalg.eigh(a), or driver='evd' with lower=True: others turn vectors round; the "
    "values alone are eigvalsh(a)",
    "eig": "write np.linalg.eigh for a symmetric matrix: other ones have complex eigenvalues",
    "eigvals": "write eigvalsh for a symmetric matrix: other ones have complex eigenvalues",
    "pinv": "write np.linalg.pinv(a), which takes other singular values for zero",
    "lstsq": "write np.linalg.lstsq(a, b, rcond=None), which takes other singular values for zero",
    "lu": "write factors = lu_factor(a) and lu_solve(factors, b)",
    "qr": "write mode='full' or mode='economic', without pivoting",
    "svd": "write full_matrices= and compute_uv= as True or False, without another driver",
    "solve": "write assume_a as 'gen', 'sym' or 'pos', and lower and transposed as True or False"}
_OTHERS = "write it with functions that have a rule, or give it one: s2sad.rule, s2sad.nondifferentiable"


@dataclass(frozen=True)
class _Factorization:
    """What a name holds: the result of such a function, or one of its parts; the triangle of a Cholesky factor."""
    function: str
    part: int | None
    lower: bool | None


def scipy_solvers(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with those functions; what cannot be followed is refused."""
    report = context.report
    if not any((call_name(n) or "").startswith(SCIPY) for n in walk(function.body)):
        return function
    new = with_body(function, [rebuild(statement, _without_ignored_options) for statement in function.body])
    pass_ = _Solvers(new, report)
    new.body = pass_.block(new.body)
    pass_.check(new.body)
    return new


def _without_ignored_options(node: AST) -> AST | None:
    """The call without options that do not change its result; `trans` as a number."""
    called = call_name(node) or ""
    if not isinstance(node, Call) or not called.startswith(SCIPY):
        return None
    keywords = [rebuild(k, _without_ignored_options) for k in node.keywords if k.arg not in IGNORED]
    args = [rebuild(a, _without_ignored_options) for a in node.args]
    if called == f"{SCIPY}solve_triangular" and len(args) == 3:
        keywords.append(keyword("trans", args.pop()))
    for k in keywords:
        if k.arg == "trans" and isinstance(k.value, Constant):
            k.value = const(_TRANS.get(k.value.value, k.value.value))
    if called == f"{SCIPY}cholesky" and (lower := _lower(args[1:], keywords)) is not None:
        return at(_cholesky(args[0], lower), node)
    written = args and isinstance(args[0], (Tuple, List)) and len(args[0].elts) == 2
    if called == f"{SCIPY}solve_banded" and written and len(args) == 3 and not keywords:
        return at(call("runtime.solve_banded", args[1], args[2], *args[0].elts), node)
    return at(Call(node.func, args, keywords), node)


def _lower(rest: list[AST], keywords: list[AST]) -> bool | None:
    """The option `lower`, False by default; None if it is no constant."""
    given = [*rest, *(k.value for k in keywords)]
    if any(k.arg != "lower" for k in keywords) or len(given) > 1:
        return None
    value = getattr(given[0], "value", None) if given else False
    return value if isinstance(value, bool) else None


def _cholesky(a: AST, lower: bool) -> AST:
    if lower:
        return call("numpy.linalg.cholesky", a)
    return transposed_matrices(call("numpy.linalg.cholesky", transposed_matrices(a)))


class _Solvers:
    def __init__(self, function: FunctionDef, report: Report):
        self.report = report
        stores = [n.id for n in walk(function.body) if isinstance(n, Name) and isinstance(n.ctx, Store)]
        self.held: dict[str, _Factorization] = {}
        self.own_entries: list[AST] = []
        bound = [(s.targets[0].id, s.value) for s in walk_statements(function.body)
                 if isinstance(s, Assign) and isinstance(s.targets[0], Name) and stores.count(s.targets[0].id) == 1]
        while True:
            more = {n: f for n, v in bound if n not in self.held and (f := self.factors(v)) is not None}
            if not more:
                break
            self.held |= more

    def factors(self, node: AST) -> _Factorization | None:
        """The factorization, or its item, that an expression is."""
        called = (call_name(node) or "").removeprefix(SCIPY)
        if called in _FACTORS and isinstance(node, Call):
            lower = _lower(node.args[1:], node.keywords)
            plain = lower is not None and (called == "cho_factor" or len(node.args) + len(node.keywords) == 1)
            return _Factorization(called, None, lower) if plain else None
        if isinstance(node, Name):
            return self.held.get(node.id)
        if isinstance(node, Subscript) and isinstance(node.slice, Constant) and node.slice.value in (0, 1):
            whole = self.factors(node.value)
            return whole and (_Factorization(whole.function, node.slice.value, whole.lower) if whole.part is None
                              else None)
        return None

    def block(self, block: list[AST]) -> list[AST]:
        made = []
        for statement in block:
            target = statement.targets[0] if isinstance(statement, Assign) else None
            found = self.held.get(target.id) if isinstance(target, Name) else None
            if found is not None and found.part == 1:
                continue  # the row exchanges and the triangle are in the factors
            if found is not None:
                made.append(at(Assign([target], self.factor_array(statement.value), None), statement))
                continue
            new = rebuild(statement, self.solved) if not hasattr(statement, "body") else copy(statement)
            if hasattr(statement, "body"):
                for field in statement._fields:
                    inner = getattr(statement, field)
                    setattr(new, field, self.block(inner) if field in ("body", "orelse") else rebuild(
                        inner, self.solved))
            made.append(new)
        return made

    def factor_array(self, node: AST) -> AST:
        """The array of factors that an expression is."""
        found = self.factors(node)
        if isinstance(node, Subscript):
            return self.factor_array(node.value)
        if isinstance(node, Name) or found is None:
            return copy(node)
        a = rebuild(node.args[0], self.solved)
        return call("runtime.factored", a) if found.function == "lu_factor" else _cholesky(a, bool(found.lower))

    def triangle(self, node: AST) -> AST | None:
        """What reads entries of a Cholesky factor's own triangle alone, of the factor itself."""
        given, of_lower = _entries(node)
        found = self.factors(given) if given is not None else None
        if not found or found.function != "cho_factor" or found.part != 0 or of_lower not in (None, found.lower):
            return None
        factor = self.factor_array(given)
        self.own_entries.append(factor)
        return rebuild(node, lambda n: factor if n is given else None)

    def solved(self, node: AST) -> AST | None:
        if (entries := self.triangle(node)) is not None:
            return entries
        called = (call_name(node) or "").removeprefix(SCIPY)
        if called not in _SOLVES or not isinstance(node, Call) or len(node.args) < 2:
            return None
        options = {k.arg: k.value for k in node.keywords}
        options |= {"trans": node.args[2]} if len(node.args) == 3 else {}
        b = rebuild(node.args[1], self.solved)
        given = node.args[0]
        parts = list(given.elts) if isinstance(given, Tuple) and len(given.elts) == 2 else [given, given]
        first, second = self.factors(parts[0]), self.factors(parts[1])
        if called == "lu_solve" and first and second and first.function == second.function == "lu_factor":
            trans = options.pop("trans", const(0))
            if isinstance(trans, Constant) and trans.value in (0, 1) and not options:
                return at(call("runtime.solved_transposed" if trans.value else "runtime.solved",
                               self.factor_array(parts[0]), b), node)
        if called == "cho_solve" and not options:
            written = getattr(parts[1], "value", None) if isinstance(parts[1], Constant) else None
            lower = written if isinstance(written, bool) else second.lower if second else None
            if lower is not None:
                return at(_cholesky_solution(self.factor_array(parts[0]), b, lower), node)
        return None

    def check(self, block: list[AST]) -> None:
        """Refuses what is left of such functions, and any other use of their results."""
        for node in walk(block):
            path = call_name(node) or ""
            called = path.removeprefix(SCIPY)
            if called in (*_FACTORS, *_SOLVES):
                self.report.error("S301", f"no derivative rule for {SCIPY}{called} here", node, help="write factors = "
                                  f"{called.split('_')[0]}_factor(a), once, and give it to the solver as it is")
            elif called != path and path not in TABLE and not rules.find_array(path):
                self.report.error("S301", f"no derivative rule for {path}", node,
                                  help=_HELP.get(called, _OTHERS))
        read = {id(n) for s in walk_statements(block) if isinstance(s, Assign) and isinstance(s.targets[0], Name)
                and s.targets[0].id in self.held for n in walk(s.value)}
        read |= {id(n) for a in self.own_entries for n in walk(a)}
        read |= {id(n) for c in walk(block) if (call_name(c) or "") in (
            "runtime.solved", "runtime.solved_transposed", "runtime.solve_triangular") for n in walk(c.args[0])}
        for node in walk(block):
            if isinstance(node, Name) and not isinstance(node.ctx, Store) and node.id in self.held and (
                    id(node) not in read):
                self.report.error("S301", "a factorization that is read other than by its solver", node,
                                  help="write np.linalg.cholesky for the triangle itself, np.linalg.slogdet for the "
                                  "determinant")


def _entries(node: AST) -> tuple[AST | None, bool | None]:
    """The array of which an expression reads a triangle, and whether it is the lower one; None for the diagonal."""
    if isinstance(node, Call) and not node.keywords:
        if isinstance(node.func, Attribute) and node.func.attr == "diagonal" and not node.args:
            return node.func.value, None
        called = call_name(node)
        return (node.args[0], _TRIANGLES[called]) if called in _TRIANGLES and len(node.args) == 1 else (None, None)
    places = node.slice.elts if isinstance(node, Subscript) and isinstance(node.slice, Tuple) else []
    plain = len(places) == 2 and all(isinstance(p, Name) or isinstance(getattr(p, "value", None), int) for p in places)
    return (node.value if plain and dump(places[0]) == dump(places[1]) else None), None


def _cholesky_solution(factor: AST, b: AST, lower: bool) -> AST:
    """The solution with a Cholesky factor: with the triangle and with its transpose."""
    def solve(right: AST, trans: int) -> AST:
        flag = {"lower": const(True)} if lower else {}
        return call("runtime.solve_triangular", copy(factor), right, **({"trans": const(1)} if trans else {}), **flag)
    return solve(solve(b, 0), 1) if lower else solve(solve(b, 1), 0)
