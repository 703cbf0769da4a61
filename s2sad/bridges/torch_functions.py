"""Kernels as functions of PyTorch, with their derivatives as its own; tensors and arrays share their memory."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from s2sad.bridges import torch_steps
from s2sad.bridges.bridged_kernel import BridgedKernel
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.dispatch.arguments import bind, describe, kernel_value
from s2sad.dispatch.cache import ProgramVersion, derivatives_of
from s2sad.interface.pickling import Decorated
from s2sad.interface.selection import Wrt, names_of
from s2sad.interface.value_calls import selection_of
from s2sad.live_objects.unwrap import apply_functions
from s2sad.run.tracebacks import public


@public
def torch(f: Callable[..., Any], wrt: Wrt = None, of: Wrt = None) -> TorchFunction:
    """f as a function of PyTorch's tensors, through which autograd, torch.func and vmap differentiate.

    Args: f, a function, a differentiated function or a Numba dispatcher; wrt, names or positions of the parameters that
    may have a derivative (default: all floats); of, what comes back: names of written arrays, as they are at the end,
    and "return" (default: all of them). One output comes back by itself, several as a dict by name; no argument is
    changed. Tensors without an axis are numbers for f. Second derivatives: those of `hvp`, where f returns one float.
    Raises S2sadError: S401 (names that are none, a derivative with respect to what is not in wrt, a second derivative
    that is not there), S405 (an argument that a kernel does not take, a tensor that is not on the CPU, no PyTorch); and
    what f raises. Paszke and others, PyTorch, NeurIPS 2019.

        k = s2sad.torch(f)
        k(u, rate).sum().backward()
    """
    return TorchFunction(f, wrt, of)


class TorchFunction(Decorated):
    """f as a function of PyTorch's tensors; see `torch`."""

    def __init__(self, f: Any, wrt: Wrt = None, of: Wrt = None):
        self._tensor = torch_steps.library().Tensor
        self._derivatives, self.__wrapped__ = derivatives_of(f), f
        self._wrt, self._of = names_of(wrt, f), names_of(of, f, "of")
        name, self.__module__ = getattr(f, "__name__", "f"), getattr(f, "__module__", __name__)
        self.__name__ = self.__qualname__ = name
        self.__doc__ = f"'{name}' as a function of PyTorch's tensors."

    def decorator_arguments(self) -> tuple[Any, ...]:
        return self.__wrapped__, self._wrt, self._of

    def __repr__(self) -> str:
        return f"<{self.__name__} of PyTorch>"

    @public
    def __call__(self, *args: Any, **keywords: Any) -> Any:
        given, args, keywords = apply_functions(self.__wrapped__, args, keywords)
        state = (self._derivatives if given is self.__wrapped__ else derivatives_of(given)).state()
        values, tensor = bind(state.kernel, args, keywords), self._tensor
        key = ("torch", self._wrt, self._of, selection_of(given), tuple([
            (v.dtype, v.ndim if 1 not in v.shape else tuple([n == 1 for n in v.shape]), v.device.type)
            if isinstance(v, tensor) else describe((v,)) for v in values]))
        found = state.entries.get(key)
        if found is None:
            found = state.entries[key] = _Tensors(state, given, values, self)
        return found(values)


class _Tensors:
    """A kernel for arguments of these types, some of which are tensors."""

    def __init__(self, state: ProgramVersion, f: Any, values: Sequence[Any], made_by: TorchFunction):
        names, name = state.parameters, state.kernel.name
        self.places = tuple([k for k, v in enumerate(values) if isinstance(v, made_by._tensor)])
        samples = [_sample(n, v, name) if k in self.places else v for k, (n, v) in enumerate(zip(names, values))]
        samples = [kernel_value(n, v, n in state.floats) for n, v in zip(names, samples)]
        self.kernel = BridgedKernel(state, f, samples, made_by._wrt, made_by._of)
        self._kinds = [None if isinstance(samples[k], np.ndarray) else type(samples[k]) for k in self.places]
        self.names = tuple([names[k] for k in self.places])
        self._fixed = [(k, names[k]) for k in self.places if names[k] not in self.kernel.wrt]
        self._apply = torch_steps.step_function().apply

    def __call__(self, values: list[Any]) -> Any:
        for k, name in self._fixed:
            if values[k].requires_grad:
                raise S2sadError(Diagnostic(
                    "S401", f"PyTorch differentiates '{self.kernel.name}' with respect to '{name}', which is not in "
                    "wrt", help=f'name it, wrt=(..., "{name}"), or hold it fixed: {name}.detach()'))
        tensors = [values[k] for k in self.places]
        step = torch_steps.Primal(self.kernel, self.places, self.names, self._kinds, values)
        return self.kernel.structure(self._apply(step, *tensors))


def _sample(name: str, tensor: Any, kernel: str) -> Any:
    """A value that is like what a tensor is for the kernel."""
    if tensor.device.type != "cpu":
        raise S2sadError(Diagnostic("S405", f"the argument '{name}' of '{kernel}' is on the device {tensor.device}, "
                                    "and kernels run on the CPU", help=f"pass {name}.cpu()"))
    dtype = _dtype(tensor.dtype)
    if dtype is None:
        raise S2sadError(Diagnostic("S405", f"the argument '{name}' has dtype {str(tensor.dtype).rpartition('.')[2]}",
                                    help="use float64, float32, complex128, an integer type or bool"))
    return np.zeros(tuple(tensor.shape), dtype) if tensor.ndim else dtype.type(1)


@cache
def _dtype(kind: Any) -> np.dtype | None:
    """NumPy's dtype for one of PyTorch's, None where it has none."""
    try:
        return torch_steps.library().empty(0, dtype=kind).numpy().dtype
    except TypeError:
        return None
