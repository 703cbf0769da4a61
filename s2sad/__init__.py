"""s2sad reads a NumPy function that loops and writes its arrays in place, and writes the source of its derivative.

The names below are loaded when they are first used, so that a generated file, which needs `s2sad.runtime` only, does
not load the compiler.
"""
from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from s2sad.interface.activities import (
        Active as Active, BatchDuplicated as BatchDuplicated, Const as Const, Duplicated as Duplicated,
        DuplicatedNoNeed as DuplicatedNoNeed, Forward as Forward, ForwardWithPrimal as ForwardWithPrimal,
        Reverse as Reverse, ReverseWithPrimal as ReverseWithPrimal,
    )
    from s2sad.bridges.casadi_functions import casadi as casadi
    from s2sad.bridges.jax_functions import jax as jax
    from s2sad.bridges.torch_functions import torch as torch
    from s2sad.interface.batched_inputs import Batched as Batched, batched as batched
    from s2sad.interface.differentiate import (
        Differentiated as Differentiated, autodiff as autodiff, differentiate as differentiate,
    )
    from s2sad.diagnostics import S2sadError as S2sadError, S2sadWarning as S2sadWarning
    from s2sad.interface.drivers import (
        gradient as gradient, jvp as jvp, make_zero as make_zero, value_and_gradient as value_and_gradient,
        vjp as vjp,
    )
    from s2sad.interface.jax_names import grad as grad, value_and_grad as value_and_grad
    from s2sad.interface.loop_marks import timesteps as timesteps
    from s2sad.jacobians.compression_plan import Plan as Plan
    from s2sad.jacobians.jacobian import (
        Jacobian as Jacobian, ValueAndJacobian as ValueAndJacobian, jacobian as jacobian,
        value_and_jacobian as value_and_jacobian,
    )
    from s2sad.jacobians.second_order import Hessian as Hessian, hessian as hessian, hvp as hvp
    from s2sad.odes.loss_gradients import OdeGradient as OdeGradient, ode_gradient as ode_gradient
    from s2sad.odes.right_hand_side import Ode as Ode, ode as ode
    from s2sad.interface.tapes import Tape as Tape, clear as clear
    from s2sad.program import Snapshots as Snapshots
    from s2sad.custom.user_rules import nondifferentiable as nondifferentiable, rule as rule
    from s2sad.report.bench import Bench as Bench, bench as bench
    from s2sad.report.check import Checked as Checked, check as check
    from s2sad.report.explain import Explanation as Explanation, explain as explain
    from s2sad.run.memory import Memory as Memory

__version__ = "0.1.0"
_HOMES = {
    "bridges.casadi_functions": ("casadi",),
    "bridges.jax_functions": ("jax",),
    "bridges.torch_functions": ("torch",),
    "interface.activities": ("Active", "BatchDuplicated", "Const", "Duplicated", "DuplicatedNoNeed", "Forward",
                             "ForwardWithPrimal", "Reverse", "ReverseWithPrimal"),
    "interface.batched_inputs": ("Batched", "batched"),
    "interface.differentiate": ("Differentiated", "autodiff", "differentiate"),
    "diagnostics": ("S2sadError", "S2sadWarning"),
    "custom.user_rules": ("nondifferentiable", "rule"),
    "report.bench": ("Bench", "bench"),
    "report.check": ("Checked", "check"),
    "report.explain": ("Explanation", "explain"),
    "run.memory": ("Memory",),
    "interface.jax_names": ("grad", "value_and_grad"),
    "interface.loop_marks": ("timesteps",),
    "jacobians.compression_plan": ("Plan",),
    "jacobians.jacobian": ("Jacobian", "ValueAndJacobian", "jacobian", "value_and_jacobian"),
    "jacobians.second_order": ("Hessian", "hessian", "hvp"),
    "interface.tapes": ("Tape", "clear"),
    "odes.loss_gradients": ("OdeGradient", "ode_gradient"),
    "odes.right_hand_side": ("Ode", "ode"),
    "program": ("Snapshots",),
    "interface.drivers": ("gradient", "jvp", "make_zero", "value_and_gradient", "vjp"),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}
__all__ = [
    "Active", "BatchDuplicated", "Batched", "Bench", "Checked", "Const", "Differentiated", "Duplicated",
    "DuplicatedNoNeed", "Explanation", "Forward", "ForwardWithPrimal", "Hessian", "Jacobian", "Memory", "Ode",
    "OdeGradient", "Plan", "Reverse", "ReverseWithPrimal", "S2sadError", "S2sadWarning", "Snapshots", "Tape",
    "ValueAndJacobian",
    "autodiff", "batched", "bench", "casadi", "check", "clear", "differentiate", "explain", "grad", "gradient",
    "hessian", "hvp", "jacobian", "jax", "jvp", "make_zero", "nondifferentiable", "ode", "ode_gradient", "rule",
    "timesteps", "torch", "value_and_grad", "value_and_gradient", "value_and_jacobian", "vjp",
]


if not TYPE_CHECKING:
    def __getattr__(name: str) -> Any:
        if name not in _HOME:
            raise AttributeError(import_module("s2sad.interface.foreign_names").attribute(name))
        value = getattr(import_module(f"s2sad.{_HOME[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])


class _Package(ModuleType):
    """This package: importing its room `differentiate` must not hide the function of that name."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
