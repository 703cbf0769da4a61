"""Statements as text: exact texts, the round trip through Python's own parser, and line breaking."""
from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from s2sad import tree
from s2sad.emit import text
from s2sad.emit.layout import Layout
from tests.harness.documents import ROOT

KERNELS = ROOT / "benchmarks" / "kernels"

# -- exact texts ----------------------------------------------------------------------------------------------------

EXPRESSIONS = [
    "a + b - c", "a - (b - c)", "a - (b + c)", "a / b * c", "a / (b * c)", "a * (b + c)", "(a + b) * c",
    "-x ** 2", "(-x) ** 2", "2.0 ** -x", "a ** b ** c", "(a ** b) ** c", "(-1) ** n", "-1 ** n", "(-2.0).real",
    "--x", "-(a + b)", "-a * b", "a * -b", "a - -b", "~a & b", "a << 1 | b", "a << (1 | b)", "+x", "(~x) ** 2",
    "not a", "not a == b", "(not a) == b", "not (a and b)", "not a and b", "a and (b and c)", "(a and b) and c",
    "a or b and c", "(a or b) and c", "a < b <= c", "(a < b) == c", "a < (b < c)", "a is not None", "a not in b",
    "a if b else c", "(a if b else c) + d", "a if b else c if d else e", "(a if b else c) if d else e",
    "a if (b if c else d) else e", "f(a if b else c, (1, 2))", "x[i, j]", "x[i]", "x[i,]", "x[()]", "x[(i, j), k]",
    "x[1:, ::2, ..., None]", "x[:]", "x[a + 1:b:-1]", "x[:-1][i].T", "x[i][j]", "(1).real", "(1.5).real",
    "f(x).y[z](w)", "(a + b)[i]", "(-a)[i]", "(a, b)[0]", "f(*a, k=b)", "f((yes,), [no, 1])", "(a + b).sum(axis=0)",
    "()", "(a,)", "[]", "[a]", "1e-05", "1e+300", "0.1", "True", "a @ b @ c", "a % b // c", "a % (b // c)",
    "(a := b) + 1", "f'n is {n!r:>{w}} {{}}'", "1j * x",
]


@pytest.mark.parametrize("written", EXPRESSIONS)
def test_expression_as_written(written):
    assert text(tree.expression(written)) == written.replace("'", '"')


def lines(*rows: str) -> str:
    return "\n".join(rows)


STATEMENTS = [
    "x = 1", "x = y = 1", "a, b = b, a", "(a, b), c = d", "(a,) = p", "x[i, j] += 1", "x **= -y", "return",
    "return a, b", "return (a,)", 'assert a < b, "a must be less"', 'raise ValueError("no")', "raise", "print(a, b)",
    "x = a if b else c", "x = ()", "a = b, (c, d)", "x += a, b", "def f():\n    pass",
    "def f(a, b=1, *c, d, e=2, **g):\n    return a",
    "def f(a, /, b: float, *, c: int = 1) -> float:\n    return a", "@njit\ndef f(x):\n    return x",
    "for i in range(n):\n    break", "for a, b in zip(x, y):\n    continue\nelse:\n    pass",
    "for w in (u, v):\n    w[:] = 0",
    "while True:\n    pass", "while a and b:\n    a -= 1\nelse:\n    b = 1",
    "if a:\n    b = 1\nelif c:\n    d = 1\nelif e:\n    f = 1\nelse:\n    g = 1",
    "if a:\n    b = 1\nelse:\n    if c:\n        d = 1\n    e = 1",
]


@pytest.mark.parametrize("written", STATEMENTS)
def test_statement_as_written(written):
    assert text(tree.statements(written)) == written


@pytest.mark.parametrize(("node", "wanted"), [
    (tree.const(-2.0), "-2.0"),
    (tree.const(float("inf")), "np.inf"),
    (tree.const(-float("inf")), "-np.inf"),
    (tree.const(float("nan")), "np.nan"),
    (tree.Constant(-2.0, None), "-2.0"),
    (tree.binary(tree.Constant(-2.0, None), tree.Pow(), tree.const(2)), "(-2.0) ** 2"),
    (tree.attribute(tree.Constant(-1, None), "real"), "(-1).real"),
    (tree.const(np.float64(0.5)), "0.5"),
    (tree.const(np.float32(0.1)), "np.float32(0.1)"),
    (tree.const(np.int64(3)), "3"),
    (tree.const('say "n"'), "'say \"n\"'"),
    (tree.name("numpy.linalg.det"), "np.linalg.det"),
    (tree.name("math.pi"), "math.pi"),
    (tree.call("builtins.range", tree.name("const.N")), "range(N)"),
    (tree.call("user.f", tree.name("array.t")), "f(t)"),
    (tree.call("runtime.grow", tree.name("s"), tree.const(1)), "grow(s, 1)"),
])
def test_built_expression(node, wanted):
    assert text(node) == wanted


def test_comments():
    long = " ".join(["word"] * 40)
    body = [tree.comment("x = 1"), tree.If(tree.name("a"), [tree.comment("nothing")], []), tree.comment(""),
            tree.comment("two\nlines"), tree.comment(long)]
    shown = text(body).split("\n")
    assert shown[:7] == ["# x = 1", "if a:", "    # nothing", "    pass", "#", "# two", "# lines"]
    assert all(line.startswith("# ") and len(line) <= 100 for line in shown[7:]) and len(shown) == 10
    assert " ".join(line[2:].strip() for line in shown[7:]) == long


def test_functions_are_two_lines_apart():
    body = [tree.comment("first"), *tree.statements("def f():\n    pass\ndef g():\n    pass\nx = 1")]
    body.insert(2, tree.comment("second"))
    assert text(body) == lines("# first", "def f():", "    pass", "", "", "# second", "def g():", "    pass", "", "",
                               "x = 1")


def test_names_of_ones_own():
    node = tree.call("numpy.exp", tree.name("const.G"))
    assert text(node, {"numpy": "np_", "const.G": "G_"}) == "np_.exp(G_)"


# -- lines ----------------------------------------------------------------------------------------------------------

def test_long_lines_are_broken_after_operators():
    [node] = tree.statements(
        "if 1:\n    du[i, j, 0] = alpha * (u[im1, j, 0] + u[ip1, j, 0] + u[i, jp1, 0] - 4.0 * u[i, j, 0]) + b")
    assert text(node, width=60) == lines(
        "if 1:",
        "    du[i, j, 0] = (",
        "        alpha * (",
        "            u[im1, j, 0] + u[ip1, j, 0] + u[i, jp1, 0] -",
        "            4.0 * u[i, j, 0]",
        "        ) + b",
        "    )")


@pytest.mark.parametrize(("written", "wanted"), [
    ("x = f(aaaaaaaaaa, bbbbbbbbbb, cccccccccc, ddd)",
     ["x = f(", "    aaaaaaaaaa, bbbbbbbbbb,", "    cccccccccc, ddd", ")"]),
    ("x = aaaaaaaaaa + bbbbbbbbbb * ccccccccc + d",
     ["x = (", "    aaaaaaaaaa +", "    bbbbbbbbbb * ccccccccc + d", ")"]),
    ("if aaaaaaaaaa < bbbbbbbbbb and ccccccccc: pass",
     ["if (", "    aaaaaaaaaa < bbbbbbbbbb and", "    ccccccccc", "):", "    pass"]),
    ("def fffffffff(aaaaaaaaaa, bbbbbbbbb, cc): pass",
     ["def fffffffff(", "    aaaaaaaaaa, bbbbbbbbb, cc", "):", "    pass"]),
    ("return aaaaaaaaaa, bbbbbbbbbb, ccccccccc, d",
     ["return (", "    aaaaaaaaaa, bbbbbbbbbb,", "    ccccccccc, d", ")"]),
    ("aaaaaaaaaaaa = bbbbbbbbbbbbbbbbbbbbbbb", ["aaaaaaaaaaaa = (", "    bbbbbbbbbbbbbbbbbbbbbbb", ")"]),
    ("aaaaaaaaa, bbbbbbbbb, ccccccccc = ddddddd",
     ["aaaaaaaaa, bbbbbbbbb, ccccccccc = (", "    ddddddd", ")"]),
])
def test_broken_statement(written, wanted):
    width = 36 if "ddddddd" in written else 32
    assert text(tree.statements(written), width=width) == lines(*wanted)


def test_long_strings_are_split():
    words = "the number of cells must be positive and even, " * 4
    node = tree.Assert(tree.name("n"), tree.const(words))
    shown = text(node)
    assert max(map(len, shown.split("\n"))) <= 100 and tree.equal(tree.statements(shown)[0], node)


def test_an_expression_stays_on_one_line():
    assert text(tree.expression(" + ".join(["abcdefgh"] * 40))).count("\n") == 0


def test_long_chains_need_no_recursion():
    node = tree.name("a")
    for _ in range(5000):
        node = tree.add(node, tree.name("b"))
    assert text(node) == "a" + " + b" * 5000


# -- the round trip -------------------------------------------------------------------------------------------------

NAMES = st.sampled_from(["a", "b", "velocity", "u_bar", "np", "a_rather_long_name_of_an_array"])
FINITE = st.floats(min_value=0.0, allow_nan=False, allow_infinity=False)
CONSTANTS = st.one_of(st.integers(0, 10 ** 6), FINITE, st.booleans(), st.none(), st.text(max_size=5),
                      st.text(st.sampled_from("ab c'\"\\\n"), min_size=61, max_size=150))
BINARY = [tree.Add, tree.Sub, tree.Mult, tree.Div, tree.FloorDiv, tree.Mod, tree.Pow, tree.MatMult, tree.LShift,
          tree.RShift, tree.BitAnd, tree.BitOr, tree.BitXor]
COMPARISONS = [tree.Lt, tree.LtE, tree.Gt, tree.GtE, tree.Eq, tree.NotEq, tree.Is, tree.IsNot, tree.In, tree.NotIn]


@st.composite
def expressions(draw, depth=3):
    """Any expression; drawn by hand, for a strategy built of strategies is slow to print when it fails."""
    if depth == 0 or draw(st.integers(0, 3)) == 0:
        return tree.name(draw(NAMES)) if draw(st.booleans()) else tree.Constant(draw(CONSTANTS), None)

    def one():
        return draw(expressions(depth=depth - 1))

    def some(least=0):
        return [one() for _ in range(draw(st.integers(least, 3)))]

    def part():
        bounds = [one() if draw(st.booleans()) else None for _ in range(3)]
        return tree.Slice(*bounds) if draw(st.booleans()) else one()

    kind = draw(st.sampled_from(["binary", "binary", "unary", "boolean", "compare", "choice", "subscript", "subscripts",
                                 "call", "attribute", "tuple", "list"]))
    if kind == "binary":
        return tree.binary(one(), draw(st.sampled_from(BINARY))(), one())
    if kind == "unary":
        return tree.UnaryOp(draw(st.sampled_from([tree.USub, tree.UAdd, tree.Not, tree.Invert]))(), one())
    if kind == "boolean":
        return tree.BoolOp(draw(st.sampled_from([tree.And, tree.Or]))(), some(2))
    if kind == "compare":
        others = some(1)
        return tree.Compare(one(), [draw(st.sampled_from(COMPARISONS))() for _ in others], others)
    if kind == "choice":
        return tree.IfExp(one(), one(), one())
    if kind == "subscript":
        return tree.index(one(), part())
    if kind == "subscripts":
        items = [part() for _ in range(draw(st.integers(0, 3)))]
        return tree.Subscript(one(), tree.tuple_of(*items), tree.Load())
    if kind == "call":
        words = draw(st.lists(st.sampled_from(["axis", "out"]), unique=True))
        return tree.Call(one(), some(), [tree.keyword(word, one()) for word in words])
    if kind == "attribute":
        return tree.attribute(one(), draw(st.sampled_from(["shape", "T"])))
    return tree.tuple_of(*some()) if kind == "tuple" else tree.List(some(), tree.Load())


@st.composite
def targets(draw, depth=1):
    if depth and draw(st.booleans()):
        return tree.tuple_of(*[draw(targets(depth=depth - 1)) for _ in range(draw(st.integers(1, 4)))])
    name = tree.name(draw(NAMES))
    return tree.index(name, draw(expressions(depth=2))) if draw(st.booleans()) else name


@st.composite
def statements(draw, depth=2):
    def value():
        return draw(expressions())

    def maybe():
        return value() if draw(st.booleans()) else None

    def body(least):
        return [draw(statements(depth=depth - 1)) for _ in range(draw(st.integers(least, 2)))]

    kind = draw(st.sampled_from(["assign", "augment", "assert", "return", "raise", "value", "pass"]
                                + ["if", "if", "while", "for", "function"] * (depth > 0)))
    if kind == "assign":
        return tree.assign(draw(targets()), value())
    if kind == "augment":
        return tree.augment(draw(targets(depth=0)), draw(st.sampled_from(BINARY))(), value())
    if kind in ("assert", "raise"):
        return (tree.Assert if kind == "assert" else tree.Raise)(value(), maybe())
    if kind == "return":
        return tree.Return(maybe())
    if kind in ("value", "pass"):
        return tree.Expr(value()) if kind == "value" else draw(st.sampled_from([tree.Pass, tree.Break]))()
    if kind == "function":
        return tree.function("f", draw(st.lists(NAMES, unique=True)), body(1))
    if kind == "for":
        stored = tree.assign(draw(targets()), tree.const(0)).targets[0]
        return tree.For(stored, value(), body(1), body(0), None)
    return (tree.If if kind == "if" else tree.While)(value(), body(1), body(0))


@given(expressions(depth=5))
def test_expressions_come_back(node):
    assert tree.equal(tree.expression(text(node)), node)


@given(statements(), st.sampled_from([100, 60, 30, None]))
def test_statements_come_back(node, width):
    back = tree.statements(text(node, width=width))
    assert tree.equal(tree.Module(back, []), tree.Module([node], []))


@pytest.mark.parametrize("width", [100, 50, 20])
def test_reference_kernels_come_back(width):
    for path in sorted(KERNELS.glob("*.py")):
        node = tree.parse(path.read_text())
        shown = text(node, width=width)
        assert tree.equal(tree.parse(shown), node)
        assert width < 100 or all(len(line) <= 100 for line in shown.splitlines() if '"""' not in line)


def test_layout_writes_to_a_file(tmp_path):
    with open(tmp_path / "out.py", "w") as file:
        Layout(tree.statements("x = 1"), file)
    assert (tmp_path / "out.py").read_text() == "x = 1\n"
