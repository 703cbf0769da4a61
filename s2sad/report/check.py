"""check: are the derivatives right? Tangent against adjoint, and tangent against differences of the original."""
from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np

from s2sad.program import Request
from s2sad.report.differences import differences
from s2sad.report.divergence import wrong_adjoint, wrong_tangent
from s2sad.report.measured_call import MeasuredCall
from s2sad.report.vector_function import VectorFunction, flat, split, vector_of
from s2sad.rules import constant_result
from s2sad.live_objects.registry import ROOM
from s2sad.run.compiled import bounds_checked
from s2sad.interface.selection import Wrt
from s2sad.run.tracebacks import public


_VERDICTS = {True: "&#10003; agrees", False: "&#10007; parts"}


@dataclass(frozen=True)
class Checked:
    """The report: true if all agree; `str(it)` is what was measured and, where they disagree, the first place.

    `dot_product` and `tangent` are distances as fractions of the magnitudes; `unsure` counts the outputs of which the
    differences say nothing, because a kink or a jump is near. Where a function has an adjoint of its own and no tangent
    the adjoint is compared `with_differences`; where it has a tangent and no adjoint there is no dot product.
    """
    title: str
    dot_product: float
    dot_tolerance: float
    tangent: dict[str, float]
    tolerance: float
    unsure: int
    outputs: int
    where: str = ""
    with_differences: bool = False

    def __bool__(self) -> bool:
        return self.adjoint_holds and self.tangent_holds

    @property
    def adjoint_holds(self) -> bool:
        return self.dot_product <= self.dot_tolerance

    @property
    def tangent_holds(self) -> bool:
        return all(d <= self.tolerance for d in self.tangent.values())

    def measured(self) -> list[tuple[str, float, float]]:
        """What was compared, how far it is apart, and how far it may be."""
        other = "differences" if self.with_differences else "tangent"
        return [(f"adjoint with {other} (dot product)", self.dot_product, self.dot_tolerance),
                *((f"tangent of {name} with differences", d, self.tolerance) for name, d in self.tangent.items())]

    def remarks(self) -> list[str]:
        unsure = [f"the differences say nothing of {self.unsure} of {self.outputs} numbers: a kink or a jump is near, "
                  "or they are not finite"] if self.unsure else []
        return [*unsure, *([self.where] if self.where else [])]

    def __str__(self) -> str:
        lines = [f"  {what}: {'agrees' if apart <= allowed else 'PARTS'}, apart by {apart:.1e}, {allowed:.0e} allowed"
                 for what, apart, allowed in self.measured()]
        return "\n".join([self.title, *lines, *(f"  {r}" for r in self.remarks())])

    def _repr_html_(self) -> str:
        """What a notebook shows: a table of what was compared."""
        rows = [f'<tr><td style="text-align: left">{escape(what)}</td><td><b>{_VERDICTS[apart <= allowed]}</b></td>'
                f"<td>{apart:.1e}</td><td>{allowed:.0e}</td></tr>" for what, apart, allowed in self.measured()]
        return (f"<table><caption>{escape(self.title)}</caption><tr><th>compared</th><th></th><th>apart by</th>"
                f"<th>allowed</th></tr>{''.join(rows)}</table>{''.join(f'<p>{escape(r)}</p>' for r in self.remarks())}")


@public
def check(f: Callable[..., Any], *args: Any, wrt: Wrt = None,
          of: str | Iterable[str] | None = None, engine: str | None = None, seed: int = 0) -> Checked:
    """Runs f and its derivatives at args, and compares them; args are not changed.

    Args: args, f's arguments; wrt, of and engine as for `differentiate` (default: what f carries); seed of the random
    direction and weights. The adjoint is compared with the tangent through the dot product (1e-12 of the sum of
    magnitudes, 1e-4 with float32), the tangent with extrapolated differences of f itself (1e-6 beyond the error that
    they estimate of themselves). Compiled code runs with bounds checks. The report is a `Checked`, false if something
    parts; it then names the first statement where it does.
    Raises S2sadError as `f.adjoint` does; and what f raises.
    Literature: Griewank and Walther, Evaluating Derivatives, SIAM 2008; Ridders, Adv. Eng. Software 4, 1982.

    >>> def cube(x):
    ...     return x * x * x
    >>> bool(check(cube, 2.0, engine="numpy"))
    True
    """
    return _Measurement(MeasuredCall.for_call(f, args, wrt, of, engine), seed).made()


class _Measurement:
    def __init__(self, measured: MeasuredCall, seed: int):
        values, wrt, of = measured.values, measured.wrt, measured.of
        self.measured, self.state, self.values, self.wrt, self.of = measured, measured.state, values, wrt, of
        self.function_of_x = VectorFunction(measured.original, values, wrt, of)
        self.outputs = self.function_of_x.narrowed(values)
        self.dot_tolerance, self.tolerance = (1e-4, 2e-3) if measured.is_single_precision else (1e-12, 1e-6)
        rng = np.random.default_rng(seed)
        wished = rng.standard_normal(self.function_of_x.x.size) * self.function_of_x.scales()
        self.x_dot = split(values, wrt, wished)
        self.direction = vector_of(self.x_dot, wrt)
        self.seeds = split(self.outputs, of, rng.standard_normal(vector_of(self.outputs, of).size))

    def made(self) -> Checked:
        if not self.measured.has_tangent():
            return self.made_without_tangent()
        tangents, gradients = self.derivatives()
        y_dot, x_bar = vector_of(tangents, self.of), vector_of(gradients, self.wrt)
        y_bar = vector_of(self.seeds, self.of)
        magnitude = float(np.abs(y_bar * y_dot).sum() + np.abs(x_bar * self.direction).sum())
        distance = abs(_sum(y_bar * y_dot) - _sum(x_bar * self.direction))
        finite = np.all(np.isfinite(vector_of(self.outputs, self.of)))
        apart = distance / magnitude if magnitude else 0.0
        apart = apart if math.isfinite(apart) else math.inf if finite else 0.0
        expected, error = differences(self.function_of_x.along(self.direction))
        known = np.isfinite(error)
        found = Checked(self.title(), apart, self.dot_tolerance, self.by_output(y_dot, expected, error, known),
                        self.tolerance, int((~known).sum()), known.size)
        return found if found else Checked(**{**vars(found), "where": self.where(found, _sum(y_bar * y_dot))})

    def made_without_tangent(self) -> Checked:
        """The adjoint against differences, where these are sure."""
        expected, error = differences(self.function_of_x.along(self.direction))
        known = np.isfinite(error)
        weights = np.where(known, vector_of(self.seeds, self.of), 0.0)
        self.seeds = split(self.outputs, self.of, weights)
        with bounds_checked():
            x_bar = vector_of(self.measured.reverse().vjp(self.measured.arguments, self.seeds), self.wrt)
        terms, slopes = x_bar * self.direction, np.where(known, weights * np.where(known, expected, 0.0), 0.0)
        beyond = max(abs(_sum(terms) - _sum(slopes)) - 10 * _sum(np.abs(weights[known]) * error[known]), 0.0)
        magnitude = float(np.abs(terms).sum() + np.abs(slopes).sum())
        apart = beyond / magnitude if magnitude else 0.0
        own = ", ".join(g.path for k in self.state.program.kernels.values() if k.own is not None
                        for what, g in k.own.functions.items() if what in ("adjoint", "reverse"))
        return Checked(self.title(), apart if math.isfinite(apart) else math.inf, self.tolerance, {}, self.tolerance,
                       int((~known).sum()), known.size,
                       "" if apart <= self.tolerance else f"adjoints of the user's own, without tangents: {own}", True)

    def title(self) -> str:
        return f"Check of {self.measured.title}{', with bounds checks' if self.measured.engine == 'numba' else ''}"

    def derivatives(self) -> tuple[dict[str, Any], dict[str, Any]]:
        args = self.measured.arguments
        with bounds_checked():
            return self.measured.forward().jvp(args, self.x_dot), self.measured.reverse().vjp(args, self.seeds)

    def by_output(self, y_dot: np.ndarray, expected: np.ndarray, error: np.ndarray, known: np.ndarray
                  ) -> dict[str, float]:
        """The largest distance beyond the differences' own error, by output."""
        top = 1e-2 * float(np.abs(expected[known]).max(initial=0.0))
        beyond = np.where(known, np.maximum(np.abs(y_dot - expected) - 10 * error, 0.0), 0.0)
        beyond = np.where(np.isnan(beyond), math.inf, beyond)
        apart = beyond / np.maximum(np.abs(expected) + top, np.finfo(float).tiny)
        found, at = {}, 0
        for name in self.of:
            size = flat(self.outputs[name]).size
            found[name] = float(apart[at:at + size].max(initial=0.0))
            at += size
        return found

    def where(self, found: Checked, total: float) -> str:
        """The first statement where they part, in words."""
        def request(mode: str) -> Request:
            return Request(mode, self.measured.types, self.wrt, self.of)
        values = {**self.values, **self.state.private_outside_arrays(self.measured.types)}
        if not found.tangent_holds:
            fixed = ", ".join(g.path for g in self.state.registered if constant_result(ROOM + g.path))
            if fixed:
                return f"held fixed by s2sad.nondifferentiable, which differences do not do: {fixed}"
            place = wrong_tangent(self.state.program, request("tangent"), values, self.x_dot)
            return f"the tangent parts from the differences first at {place}" if place else _LOST
        place = wrong_adjoint(self.state.program, request, values, self.x_dot, self.seeds, total)
        return f"the adjoint is wrong first, going backwards, at {place}" if place else _LOST


_LOST = "the statement could not be found: each one is right by itself, what the simplified text makes of them is not"


def _sum(values: np.ndarray) -> float:
    return math.fsum(values) if np.all(np.isfinite(values)) else float(np.sum(values))
