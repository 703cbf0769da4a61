"""Functions that are another one under another name or with other arguments, in the spelling that has a rule."""
from __future__ import annotations

import inspect
from dataclasses import dataclass

from s2sad import tree
from s2sad.rules import array, rule
from s2sad.rules.rule import template
from s2sad.tree import AST, Call, call_name


@dataclass(frozen=True)
class Spelling:
    """The parameters of a function with their defaults, and what a call of it is over them."""
    parameters: inspect.Signature
    defaults: dict[str, AST]
    value: AST

    def of(self, node: Call) -> AST | None:
        """The call in its other spelling; None if its arguments do not fit."""
        try:
            given = self.parameters.bind(*node.args, **{str(k.arg): k.value for k in node.keywords})
        except TypeError:
            return None
        return tree.substitute(self.value, {**self.defaults, **given.arguments})


TABLE: dict[str, Spelling] = {}


def same(text: str, value: str) -> None:
    """Registers what a call such as "numpy.fliplr(x)" is; each parameter stands once in it."""
    called = template(text)
    defaults = {str(k.arg): k.value for k in called.keywords}
    names = [*(a.id for a in called.args), *defaults]
    read = [n.id for n in tree.walk(template(value)) if isinstance(n, tree.Name) and "." not in n.id]
    if sorted(read) != sorted(names):
        raise ValueError(f"{text!r}: its parameters do not stand in {value!r} once each")
    parameters = [inspect.Parameter(n, inspect.Parameter.POSITIONAL_OR_KEYWORD,
                                    default=None if n in defaults else inspect.Parameter.empty) for n in names]
    TABLE[call_name(called) or ""] = Spelling(inspect.Signature(parameters), defaults, template(value))


def is_scipy(path: str) -> bool:
    """Whether a function of SciPy's has a derivative here, or may: `normalize/library/differentiable` says which of
    `scipy.linalg` have none, and `evaluate/specialize/sparse` which of `scipy.sparse`."""
    known = path in TABLE or path in rule.TABLE.rules or path in array.TABLE
    return known or path.rpartition(".")[0] in ("scipy.linalg", "scipy.sparse", "scipy.sparse.linalg")


def other_spelling(node: Call) -> AST | None:
    """The call in the spelling that has a rule, if it has another one."""
    found = TABLE.get(call_name(node) or "")
    return found.of(node) if found else None


for _ufunc, _function in (("add", "sum"), ("multiply", "prod"), ("maximum", "max"), ("minimum", "min")):
    same(f"numpy.{_ufunc}.reduce(array, axis=0, keepdims=False)",
         f"numpy.{_function}(array, axis=axis, keepdims=keepdims)")
same("numpy.add.accumulate(array, axis=0)", "numpy.cumsum(array, axis=axis)")
same("numpy.multiply.accumulate(array, axis=0)", "numpy.cumprod(array, axis=axis)")
same("numpy.hypot.reduce(array, axis=0, keepdims=False)", "numpy.linalg.norm(array, axis=axis, keepdims=keepdims)")
same("numpy.logaddexp.reduce(array, axis=0, keepdims=False)",
     "scipy.special.logsumexp(array, axis=axis, keepdims=keepdims)")
for _function in ("inv(a)", "det(a)", "norm(a, ord=None, axis=None, keepdims=False)"):
    _name, _, _rest = _function.partition("(")
    _given = ", ".join(f"{p}={p}" if d else p for p, d, _ in (p.partition("=") for p in _rest[:-1].split(", ")))
    same(f"scipy.linalg.{_function}", f"numpy.linalg.{_name}({_given})")
same("scipy.linalg.svdvals(a)", "runtime.singular_values(a)")
same("scipy.linalg.expm(a)", "runtime.exponential(a)")
same("scipy.linalg.solve_triangular(a, b, trans=0, lower=False, unit_diagonal=False)",
     "runtime.solve_triangular(a, b, trans=trans, lower=lower, unit=unit_diagonal)")
for _function in ("fft", "ifft", "rfft", "irfft"):
    same(f"scipy.fft.{_function}(x, n=None, axis=-1, norm=None)",
         f"numpy.fft.{_function}(x, n=n, axis=axis, norm=norm)")
    same(f"scipy.fft.{_function}2(x, s=None, axes=(-2, -1), norm=None)",
         f"numpy.fft.{_function}2(x, s=s, axes=axes, norm=norm)")
    same(f"scipy.fft.{_function}n(x, s=None, axes=None, norm=None)",
         f"numpy.fft.{_function}n(x, s=s, axes=axes, norm=norm)")
for _function in ("fftfreq(n, d=1.0)", "rfftfreq(n, d=1.0)"):
    same(f"scipy.fft.{_function}", f"numpy.fft.{_function}".replace("d=1.0", "d=d"))
for _function in ("fftshift", "ifftshift"):
    same(f"scipy.fft.{_function}(x, axes=None)", f"numpy.fft.{_function}(x, axes=axes)")
for _function in ("exp2", "expm1", "log1p", "cbrt"):
    same(f"scipy.special.{_function}(x)", f"numpy.{_function}(x)")
same("scipy.special.exp10(x)", "10.0 ** x")
same("scipy.special.log_expit(x)", "-numpy.logaddexp(0.0, -x)")
same("scipy.special.ndtr(x)", "0.5 * scipy.special.erfc(-0.7071067811865476 * x)")
same("numpy.logspace(start, stop, num=50, endpoint=True, base=10.0)",
     "base ** numpy.linspace(start, stop, num=num, endpoint=endpoint)")
same("numpy.polynomial.polynomial.polyval(x, c)", "numpy.polyval(numpy.flip(c), x)")
same("numpy.ldexp(x, i)", "x * 2.0 ** i")
same("math.ldexp(x, i)", "x * 2.0 ** i")
same("numpy.flatnonzero(a)", "numpy.nonzero(numpy.ravel(a), part=0)")
for _function in ("trace(x, offset=0)", "diagonal(x, offset=0)"):     # of a matrix
    same(f"numpy.linalg.{_function}", f"numpy.{_function}".replace("offset=0", "offset=offset"))
for _function in ("outer(a, b)", "matmul(a, b)", "cross(a, b)", "tensordot(a, b, axes=2)"):
    same(f"numpy.linalg.{_function}", f"numpy.{_function}".replace("axes=2", "axes=axes"))
for _function in ("numpy.vecdot", "numpy.linalg.vecdot"):
    same(f"{_function}(a, b)", "numpy.sum(numpy.conj(a) * b, axis=-1)")
same("numpy.linalg.svdvals(a)", "runtime.singular_values(a)")
same("numpy.linalg.matrix_norm(x, keepdims=False, ord='fro')",
     "numpy.linalg.norm(x, ord=ord, axis=(-2, -1), keepdims=keepdims)")
for _function, _other in (("double", "float64"), ("single", "float32"), ("cdouble", "complex128")):
    same(f"numpy.{_function}(x)", f"numpy.{_other}(x)")
same("numpy.ediff1d(a)", "numpy.diff(numpy.ravel(a))")
same("numpy.fliplr(m)", "numpy.flip(m, axis=1)")
same("numpy.flipud(m)", "numpy.flip(m, axis=0)")
same("numpy.ndarray(shape, dtype=numpy.float64)", "numpy.empty(shape, dtype=dtype)")
same("numpy.flatten(a)", "numpy.copy(numpy.ravel(a))")  # the method
