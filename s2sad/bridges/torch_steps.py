"""What PyTorch records: a primal, its adjoint and its tangent, and the derivative of an adjoint.

Each is a step, a function of tensors that knows the step behind it. Tensors become arrays inside of steps only, where
nothing is recorded: what has no step behind it is an error, not a zero.
"""
from __future__ import annotations

import inspect
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from s2sad.bridges.bridged_kernel import BridgedKernel
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.extras import needed
from s2sad.interface.selection import RETURN
from s2sad.jacobians.second_order import hvp


@cache
def library() -> Any:
    """PyTorch."""
    return needed("torch", "s2sad.torch")


@cache
def step_function() -> Any:
    """The `autograd.Function` that runs a step."""
    torch = library()

    class Step(torch.autograd.Function):
        @staticmethod
        def forward(step: Any, *tensors: Any) -> tuple[Any, ...]:
            return step.run(tensors)

        @staticmethod
        def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
            ctx.step = inputs[0]
            ctx.save_for_backward(*inputs[1:])
            ctx.save_for_forward(*inputs[1:])
            ctx.set_materialize_grads(False)

        @staticmethod
        def backward(ctx: Any, *seeds: Any) -> tuple[Any, ...]:
            return None, *ctx.step.backward(ctx.saved_tensors, seeds, ctx.needs_input_grad[1:])

        @staticmethod
        def jvp(ctx: Any, step: Any, *tangents: Any) -> tuple[Any, ...]:
            return ctx.step.jvp(ctx.saved_tensors, tangents)

        @staticmethod
        def vmap(info: Any, in_dims: Any, step: Any, *tensors: Any) -> tuple[Any, Any]:
            rows = [Step.apply(step, *(t if d is None else t.select(d, n) for t, d in zip(tensors, in_dims[1:])))
                    for n in range(info.batch_size)]
            return tuple(map(torch.stack, zip(*rows))), (0,) * len(rows[0])
    forward: Any = Step.forward
    forward.__signature__ = _ByPosition([*inspect.signature(forward).parameters.values()])
    return Step


class _ByPosition(inspect.Signature):
    """The signature of a function that is given all arguments by position: PyTorch binds them at each call, to fill in
    defaults, which takes as long as all else that it does."""

    def bind(self, /, *args: Any, **keywords: Any) -> Any:
        return _Bound(args, keywords)


class _Bound(NamedTuple):
    args: tuple[Any, ...]
    kwargs: dict[str, Any]

    def apply_defaults(self) -> None:
        """There are none."""


class _KernelStep:
    """A step of a kernel; `values` are its arguments, of which those at `places` are tensors with these names."""

    def __init__(self, kernel: BridgedKernel, places: tuple[int, ...], names: tuple[str, ...], kinds: Sequence[Any],
                 values: Sequence[Any]):
        self.kernel, self.places, self.names, self.kinds = kernel, places, names, kinds
        self.values = list(values)
        for place in places:
            self.values[place] = None       # they come with each call

    def given(self) -> tuple[Any, ...]:
        return self.kernel, self.places, self.names, self.kinds, self.values

    def arguments(self, tensors: Sequence[Any]) -> list[Any]:
        """The kernel's values: arrays in the memory of tensors, and numbers."""
        values = list(self.values)
        for place, kind, tensor in zip(self.places, self.kinds, tensors):
            values[place] = _array(tensor) if kind is None else kind(tensor.item())
        return values

    def like(self, names: Sequence[str], found: Sequence[Any], tensors: Sequence[Any]) -> tuple[Any, ...]:
        """Tensors of the dtypes of these arguments."""
        by_name = dict(zip(self.names, tensors))
        return tuple([_tensor(value, by_name[n].dtype) for n, value in zip(names, found)])

    def spread(self, names: Sequence[str], found: Sequence[Any]) -> tuple[Any, ...]:
        """What was found of some of the arguments, None for the others."""
        by_name = dict(zip(names, found))
        return tuple([by_name.get(n) for n in self.names])

    def apply(self, step: Any, *tensors: Any) -> tuple[Any, ...]:
        return step_function().apply(step, *tensors)

    def backward(self, saved: Any, seeds: Any, needs: Any) -> Any:
        raise self.refused()

    def jvp(self, saved: Any, tangents: Any) -> Any:
        raise self.refused()

    def refused(self) -> S2sadError:
        return S2sadError(Diagnostic(
            "S401", f"PyTorch asks for a derivative of a derivative of '{self.kernel.name}'", help="there are second "
            "derivatives, backwards twice, of a function that returns one float: write one that returns the loss"))


class Primal(_KernelStep):
    """The kernel itself."""
    made: tuple[Any, ...] = ()

    def run(self, tensors: Sequence[Any]) -> tuple[Any, ...]:
        found = self.kernel.primal(self.arguments(tensors))
        made = tuple([_tensor(value, o.type.dtype) for o, value in zip(self.kernel.outputs, found)])
        self.made = tuple([(t.shape, t.dtype) for t in made])
        return made

    def _counted(self, seeds: Any) -> list[tuple[Any, Any]]:
        """The outputs that count, with their seeds: zeros for parts of a tuple of which another part has one."""
        of = {o.name for o, s in zip(self.kernel.outputs, seeds) if s is not None}
        return [(o, library().zeros(shape, dtype=dtype) if s is None else s)
                for o, s, (shape, dtype) in zip(self.kernel.outputs, seeds, self.made) if o.name in of]

    def backward(self, saved: Any, seeds: Any, needs: Any) -> Any:
        outputs = self._counted(seeds)
        wrt = tuple([n for n, is_needed in zip(self.names, needs) if is_needed])
        if not outputs or not wrt:
            return (None,) * len(saved)
        step = Adjoint(*self.given())
        step.wrt, step.outputs = wrt, tuple([o for o, _ in outputs])
        given = (*saved, *(s for _, s in outputs))
        return self.spread(wrt, self.apply(step, *given) if library().is_grad_enabled() else step.run(given))

    def jvp(self, saved: Any, tangents: Any) -> Any:
        step = Tangent(*self.given())
        step.wrt = tuple([n for n, t in zip(self.names, tangents) if t is not None])
        return self.apply(step, *saved, *(t for t in tangents if t is not None))


class Adjoint(_KernelStep):
    """The adjoints of `wrt` for seeds of `outputs`."""
    wrt: tuple[str, ...] = ()
    outputs: tuple[Any, ...] = ()

    def run(self, tensors: Sequence[Any]) -> tuple[Any, ...]:
        count = len(self.places)
        seeds = [_array(t) if o.type.is_array else t.item() for o, t in zip(self.outputs, tensors[count:])]
        of = tuple(dict.fromkeys(o.name for o in self.outputs))
        return self.like(self.wrt, self.kernel.vjp(self.arguments(tensors), seeds, self.wrt, of), tensors)

    def backward(self, saved: Any, seeds: Any, needs: Any) -> Any:
        step = self._second()
        step.along = tuple([n for n, s in zip(self.wrt, seeds) if s is not None])
        step.wrt = tuple([n for n, is_needed in zip(self.names, needs) if is_needed])
        if not step.along:
            return (None,) * len(saved)
        *found, of_seed = self.apply(step, *saved, *(s for s in seeds if s is not None))
        return (*self.spread(step.wrt, found), of_seed if needs[len(self.places)] else None)

    def jvp(self, saved: Any, tangents: Any) -> Any:
        """Of the seed times the gradient: the Hessian is its own transpose."""
        step, (*along, seed) = self._second(), tangents
        step.along, step.wrt = tuple([n for n, t in zip(self.names, along) if t is not None]), self.wrt
        found = self.apply(step, *saved, *(t for t in along if t is not None))[:-1] if step.along else ()
        more = () if seed is None else self.apply(self, *saved[:-1], seed)
        return tuple([a + b for a, b in zip(found, more)]) if found and more else found or more

    def _second(self) -> SecondAdjoint:
        """The step behind this one; only where the kernel returns one float, and nothing else."""
        if len(self.kernel.outputs) > 1 or self.outputs[0].name != RETURN or self.outputs[0].type.is_array:
            raise self.refused()
        return SecondAdjoint(*self.given())


class SecondAdjoint(_KernelStep):
    """The derivative of an adjoint, with a seed, along directions: a product with the Hessian, and the slope."""
    wrt: tuple[str, ...] = ()
    along: tuple[str, ...] = ()

    def run(self, tensors: Sequence[Any]) -> tuple[Any, ...]:
        count, values = len(self.places), self.arguments(tensors)
        seed, by_name = tensors[count], dict(zip(self.names, self.kinds))
        directions = {n: _array(t) if by_name[n] is None else float(t.item())
                      for n, t in zip(self.along, tensors[count + 1:])}
        slope, = self.kernel.jvp(values, directions)
        products = hvp(self.kernel.f, values, directions, wrt=self.wrt) if self.wrt else {}
        found = [products] if len(self.wrt) == 1 else [products[n] for n in self.wrt]
        found = [seed.item() * product for product in found] if self.wrt else []
        return (*self.like(self.wrt, found, tensors), _tensor(slope, seed.dtype))


class Tangent(_KernelStep):
    """The tangents of the outputs for those of `wrt`."""
    wrt: tuple[str, ...] = ()

    def run(self, tensors: Sequence[Any]) -> tuple[Any, ...]:
        given, by_name = tensors[len(self.places):], dict(zip(self.names, self.kinds))
        tangents = {n: _array(t) if by_name[n] is None else by_name[n](t.item()) for n, t in zip(self.wrt, given)}
        found = self.kernel.jvp(self.arguments(tensors), tangents)
        by_type = dict(zip(self.names, tensors))
        shapes = [by_type[o.name].shape if o.name in by_type else None for o in self.kernel.outputs]
        return tuple([_tensor(np.broadcast_to(v, s) if s is not None and np.shape(v) != tuple(s) else v, o.type.dtype)
                      for o, v, s in zip(self.kernel.outputs, found, shapes)])


def _array(tensor: Any) -> np.ndarray:
    """The array in a tensor's memory."""
    return tensor.numpy(force=True)


def _tensor(value: Any, dtype: Any) -> Any:
    """A tensor in an array's memory, or of a number."""
    torch = library()
    if type(value) is np.ndarray and value.ndim:
        return torch.from_numpy(value)
    return torch.scalar_tensor(value, dtype=getattr(torch, dtype) if isinstance(dtype, str) else dtype)
