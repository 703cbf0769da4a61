"""Kernels as functions of JAX, with their derivatives as its rules."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from s2sad.bridges.bridged_kernel import BridgedKernel
from s2sad.bridges.xla_calls import Operand, XlaCall
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.arguments import bind, kernel_value
from s2sad.dispatch.cache import ProgramVersion, derivatives_of
from s2sad.extras import needed
from s2sad.interface.pickling import Decorated
from s2sad.interface.selection import RETURN, Wrt, names_of
from s2sad.interface.value_calls import selection_of
from s2sad.live_objects.unwrap import apply_functions
from s2sad.run.compiler_lock import COMPILER_LOCK
from s2sad.run.memory import returned_shapes
from s2sad.run.tracebacks import public


@public
def jax(f: Callable[..., Any], wrt: Wrt = None, of: Wrt = None, *, forward: bool = False) -> JaxFunction:
    """f as a function of JAX's arrays, which jit, grad, vmap, scan take as their own.

    Args: f, a function, a differentiated function or a Numba dispatcher; wrt, names or positions of the parameters that
    may have a derivative (default: all floats); of, what comes back: names of written arrays, which come back as they
    are at the end, and "return" (default: all of them). One output comes back by itself, several as a dict by name; no
    argument is changed. Arrays of JAX without an axis are numbers for f. With `forward` it has a tangent (jvp, jacfwd)
    in place of an adjoint (grad, vjp, jacrev). On CPUs XLA calls compiled derivatives directly.
    Raises S2sadError: S401 (names that are none, a derivative with respect to what is not in wrt), S405 (an argument
    that a kernel does not take, float64 where JAX has it not enabled, a result whose shape only the run tells, no JAX);
    what f raises while it runs becomes JAX's own error. Frostig, Johnson and Leary, Compiling machine learning programs
    via high-level tracing, SysML 2018.

    >>> import jax, s2sad
    >>> jax.config.update("jax_enable_x64", True)
    >>> def scale(u, c):
    ...     for i in range(u.size):
    ...         u[i] = c * u[i]
    >>> k = s2sad.jax(scale)
    >>> jax.grad(lambda c: k(jax.numpy.ones(2), c).sum())(3.0)
    Array(2., dtype=float64)
    """
    return JaxFunction(f, wrt, of, forward)


class JaxFunction(Decorated):
    """f as a function of JAX's arrays; see `jax`."""

    def __init__(self, f: Any, wrt: Wrt = None, of: Wrt = None, forward: bool = False):
        self._jax = needed("jax", "s2sad.jax")
        derivatives_of(f)
        self.__wrapped__, self._forward = f, forward
        self._wrt, self._of = names_of(wrt, f), names_of(of, f, "of")
        name, self.__module__ = getattr(f, "__name__", "f"), getattr(f, "__module__", __name__)
        self.__name__ = self.__qualname__ = name
        self.__doc__ = f"'{name}' as a function of JAX's arrays."

    def decorator_arguments(self) -> tuple[Any, ...]:
        return self.__wrapped__, self._wrt, self._of, self._forward

    def __repr__(self) -> str:
        return f"<{self.__name__} of JAX>"

    @public
    def __call__(self, *args: Any, **keywords: Any) -> Any:
        given, args, keywords = apply_functions(self.__wrapped__, args, keywords)
        state = derivatives_of(given).state()
        values, outside = bind(state.kernel, args, keywords), state.arrays_by_name()
        arguments = [_Argument.of(n, v, self._jax) for n, v in zip((*state.parameters, *outside),
                                                                  (*values, *outside.values()))]
        key = ("jax", self._wrt, self._of, self._forward, selection_of(given), self._jax.config.jax_enable_x64,
               tuple([a.key for a in arguments]))
        found = state.entries.get(key)
        if found is _BY_INTEGERS:
            key = (*key, tuple([a.value for a in arguments if type(a.value) is int]))
            found = state.entries.get(key)
        if found is None:
            found = self._traced(state, given, arguments, key)
        return found([a.value for a in arguments if not a.is_constant])

    def _traced(self, state: ProgramVersion, f: Any, arguments: Sequence[_Argument], key: Any) -> _TracedKernel:
        with COMPILER_LOCK:
            found = _TracedKernel(state, f, arguments, self)
            if found.integers and len(key) == _LENGTH:
                state.entries[key], key = _BY_INTEGERS, (*key, found.integers)
            state.entries[key] = found
        return found


_BY_INTEGERS = object()     # where the shape of a result depends on integers, each has an entry
_LENGTH = 7                 # of a key without these


class _Argument:
    """An argument as it is given: what is known of it before the run (`key`)."""

    def __init__(self, name: str, value: Any, key: tuple[Any, ...], is_constant: bool = False):
        self.name, self.value, self.key, self.is_constant = name, value, key, is_constant

    @classmethod
    def of(cls, name: str, value: Any, jax: Any) -> _Argument:
        if isinstance(value, jax.Array):
            return cls(name, value, (value.dtype, value.shape, value.weak_type))
        if isinstance(value, (np.ndarray, np.generic)):
            return cls(name, value, (value.dtype, value.shape, False))
        kinds: tuple[Any, ...] = (bool, int, float, complex)
        for kind in kinds:
            if isinstance(value, kind):     # JAX has classes of its own of these
                return cls(name, kind(value), (np.dtype(kind), (), True))
        return cls(name, value, ("constant", value if isinstance(value, str) else type(value)), True)

    def sample(self, is_float: bool) -> Any:
        """A value of the kernel's that is like it; only a number of Python's has its content."""
        if self.is_constant or isinstance(self.value, (int, float, complex)):
            return kernel_value(self.name, self.value, is_float)
        dtype, shape, weak = self.key
        if shape:
            return kernel_value(self.name, np.zeros(shape, dtype))
        number = dtype.type(1)
        return kernel_value(self.name, float(number) if weak and dtype.kind == "f" else number, is_float)


class _TracedKernel:
    """A kernel for arguments of these dtypes and shapes as one function of arrays, with its rules."""

    def __init__(self, state: ProgramVersion, f: Any, arguments: Sequence[_Argument], made_by: JaxFunction):
        self._jax = made_by._jax
        self._samples = {a.name: a.sample(a.name in state.floats) for a in arguments}
        self.kernel = BridgedKernel(state, f, [self._samples[n] for n in state.parameters], made_by._wrt, made_by._of)
        self._constants = {a.name: a.value for a in arguments if a.is_constant}
        given = [a for a in arguments if not a.is_constant]
        self._shapes = {a.name: a.key[1] for a in given}
        self.operands = tuple([self._operand(a) for a in given])
        known = {a.name: a.value if isinstance(a.value, int) else self._jax.ShapeDtypeStruct(*a.key[1::-1])
                 if a.key[1] else object() for a in given}
        self._made = self._output_shapes({**self._constants, **known})
        self.integers = tuple([a.value for a in given if type(a.value) is int]) if any(
            o.name == RETURN and o.type.is_array for o in self.kernel.outputs) else ()
        self._calls: dict[Any, XlaCall] = {}
        self._run = self._jax.jit(self._with_tangent() if made_by._forward else self._with_adjoint())

    def __call__(self, values: Sequence[Any]) -> Any:
        return self.kernel.structure(self._run(*values))

    # -- what is known before the run ----------------------------------------------------------------------------------

    def _operand(self, argument: _Argument) -> Operand:
        dtype, shape, weak = argument.key
        there = self._jax.dtypes.canonicalize_dtype(dtype)
        if there != dtype and not weak:
            raise _not_enabled(f"the argument '{argument.name.rpartition('.')[2]}' of '{self.kernel.name}' is", dtype)
        kind = None if shape else type(self._samples[argument.name])
        return Operand(argument.name, np.dtype(there), len(shape), kind)

    def _output_shapes(self, known: dict[str, Any]) -> dict[tuple[str, int], tuple[int, ...]]:
        kernel, found = self.kernel, dict[tuple[str, int], tuple[int, ...]]()
        returned = ()
        if any(o.name == RETURN and o.type.is_array for o in kernel.outputs):
            returned = returned_shapes(kernel.request("primal").generated, known)
        for o in kernel.outputs:
            if self._jax.dtypes.canonicalize_dtype(o.type.dtype) != o.type.dtype:
                raise _not_enabled(f"what '{kernel.name}' returns is" if o.name == RETURN else f"'{o.name}' is",
                                   o.type.dtype)
            shape = self._shapes[o.name] if o.name != RETURN else returned[o.place] if o.type.is_array else ()
            if shape is None or len(shape) != o.type.rank:
                raise S2sadError(Diagnostic(
                    "S405", f"the shape of what '{kernel.name}' returns is known only once it has run",
                    help="write it into an argument, whose shape JAX knows"))
            found[o.name, o.place] = shape
        return found

    def _call(self, mode: str, wrt: tuple[str, ...] = (), of: tuple[str, ...] = ()) -> XlaCall:
        key = mode, wrt, of
        if key not in self._calls:
            made = XlaCall(self.kernel, mode, self.operands, self._constants, wrt, of)
            variant, samples = made.variant, self._samples
            if variant.limited is None:
                variant.check_memory(variant.assemble(samples, samples, [0.0] * len(variant.seeds), samples))
            self._calls[key] = made
        return self._calls[key]

    # -- rules ---------------------------------------------------------------------------------------------------------

    def _primal(self, *values: Any) -> tuple[Any, ...]:
        return self._call("primal")([*self._made.values()], *values)

    def _asked(self, active: Sequence[bool]) -> tuple[str, ...]:
        """The parameters that have a derivative here; those that may have none are refused."""
        found = tuple(o.name for o, is_active in zip(self.operands, active) if is_active and o.dtype.kind in "fc")
        for name in found:
            if name not in self.kernel.wrt:
                raise S2sadError(Diagnostic(
                    "S401", f"JAX differentiates '{self.kernel.name}' with respect to '{name}', which is not in wrt",
                    help=f'name it, wrt=(..., "{name}"), or hold it fixed: jax.lax.stop_gradient({name})'))
        return found

    def _with_adjoint(self) -> Any:
        """The function with a rule for vjp: the adjoint, of the outputs that count."""
        custom = self._jax.custom_derivatives
        wrt = tuple(n for n in self.kernel.wrt if n in self._shapes)
        run = self._jax.custom_vjp(self._primal)

        def forward(*given: Any) -> Any:
            self._asked([g.perturbed for g in given])
            values = tuple([g.value for g in given])
            return self._primal(*values), values    # of one make in all traces: JAX keeps what it is of one for others

        def backward(values: Any, seeds: Any) -> tuple[Any, ...]:
            of = {o.name: None for o, s in zip(self.kernel.outputs, seeds) if type(s) is not custom.SymbolicZero}
            if not wrt or not of:
                return (None,) * len(values)
            counted = [self._dense(s, True) for o, s in zip(self.kernel.outputs, seeds) if o.name in of]
            call = self._call("adjoint", wrt, tuple(of))
            found = dict(zip(wrt, call([self._shapes[n] for n in wrt], *values, *counted)))
            return tuple(self._dense(found[o.name], True) if o.name in found else None for o in self.operands)
        run.defvjp(forward, backward, symbolic_zeros=True)
        return run

    def _with_tangent(self) -> Any:
        """The function with a rule for jvp: the tangent."""
        zero = self._jax.custom_derivatives.SymbolicZero
        run = self._jax.custom_jvp(self._primal)

        def forward(values: Any, tangents: Any) -> Any:
            asked = self._asked([type(t) is not zero for t in tangents])
            made = self._primal(*values)
            if not asked:
                return made, tuple(map(self._jax.numpy.zeros_like, made))
            given = [self._dense(t) for o, t in zip(self.operands, tangents) if o.name in asked]
            return made, self._call("tangent", asked)([*self._made.values()], *values, *given)
        run.defjvp(forward, symbolic_zeros=True)
        return run

    def _dense(self, value: Any, conjugate: bool = False) -> Any:
        """An array for what JAX hands to a rule; JAX transposes where an adjoint conjugates, too."""
        if type(value) is self._jax.custom_derivatives.SymbolicZero:
            return self._jax.numpy.zeros(value.shape, value.dtype)
        return value.conj() if conjugate and np.dtype(value.dtype).kind == "c" else value


def _not_enabled(what: str, dtype: Any) -> S2sadError:
    return S2sadError(Diagnostic("S405", f"{what} of {np.dtype(dtype)}, which JAX does not have as it is set",
                                 help='say jax.config.update("jax_enable_x64", True) first, or work in float32'))
