"""The chapter of differential equations: the time of a gradient of a loss of the solution against its error, by the
three ways of `ode_gradient`. (Rackauckas and others, A Comparison of Automatic Differentiation and Continuous
Sensitivity Analysis for Derivatives of Differential Equation Solutions, arXiv 1812.01892, has the equations.)"""
from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from time import perf_counter, process_time
from typing import Any

import numpy as np

import s2sad
from benchmarks.kernels.brusselator import brusselator
from benchmarks.kernels.cases import field
from benchmarks.kernels.equations import POLLUTION, hunters, medicine, pollution
from benchmarks.peers.sections import Chapter, Picture, Section
from benchmarks.tables import Table, seconds

TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)
MINUTES, MOST = 8.0, 15.0           # of the chapter; seconds of the calls of a way, which stops then
WAYS = {"forward": "sensitivities", "adjoint": "adjoint equation", "discrete": "fixed steps"}
ERRORS = (1e-3, 1e-6)


@dataclass(frozen=True)
class Equation:
    """A right-hand side, what it is given, SciPy's integrator for it and the method of its fixed steps, and how many
    of these there are between one time and the next."""
    f: Callable[..., Any]
    state: np.ndarray
    times: np.ndarray
    parameters: np.ndarray
    integrator: str
    method: str
    steps: tuple[int, ...]


EQUATIONS = {
    "lotka-volterra": Equation(hunters, np.array([1.0, 1.0]), np.linspace(0.0, 10.0, 11),
                               np.array([1.5, 1.0, 3.0, 1.0]), "RK45", "RK4", (5, 15, 50, 150)),
    "pollution": Equation(pollution, POLLUTION[0], np.linspace(0.0, 60.0, 7), POLLUTION[1], "BDF", "SDIRK4",
                          (1, 3, 10, 30)),
    "brusselator": Equation(brusselator, field(5), np.linspace(0.0, 1.0, 5), np.array([3.4, 1.0, 0.4, 0.2]), "BDF",
                            "SDIRK4", (1, 3, 10)),
    "pk-pd": Equation(medicine, np.array([100.0, 0.0, 0.0, 0.0, 5.0]), np.linspace(0.0, 24.0, 9),
                      np.array([1.0, 1.0, 20.0, 2.0, 10.0, 2.0, 10.0, 10.0, 2.0, 2.0, 1.0, 1.0, 2.0]), "RK45", "RK4",
                      (6, 20, 60, 200)),
}


def misfit(us):
    return np.sum((us[1:] - 1.0) ** 2)


def measure(quick: bool) -> dict[str, Any]:
    """Of each equation the points of each way: its tolerance or steps, its error, and its time."""
    found = {}
    for name, equation in EQUATIONS.items():
        f = s2sad.differentiate(equation.f, engine="numpy" if quick else "numba")
        exact = _gradient(f, equation, way="forward", method="Radau" if equation.method != "RK4" else "DOP853",
                          rtol=1e-5 if quick else 1e-9 if equation.method != "RK4" else 1e-12, atol=1e-13)()
        ways = {"forward": [{"method": equation.integrator, "rtol": r, "atol": 1e-3 * r} for r in TOLERANCES],
                "adjoint": [{"method": equation.integrator, "rtol": r, "atol": 1e-3 * r} for r in TOLERANCES],
                "discrete": [{"method": equation.method, "steps": n} for n in equation.steps]}
        found[name] = {way: _points(f, equation, way, points[:1] if quick else points, exact)
                       for way, points in ways.items()}
    return {"equations": found, "load": os.getloadavg()[0], "cores": os.cpu_count()}


def _gradient(f: Any, equation: Equation, **how: Any) -> Callable[[], np.ndarray]:
    ask = s2sad.ode_gradient(f, misfit, "p", **how)
    others = (equation.parameters,)
    return lambda: equation.parameters * ask(equation.state, equation.times, *others)[1]


def _points(f: Any, equation: Equation, way: str, points: list[dict[str, Any]], exact: np.ndarray
            ) -> list[dict[str, Any]]:
    """The points, as long as there is time: relative changes of the parameters are what is compared."""
    made, start = [], perf_counter()
    for point in points:
        run = _gradient(f, equation, way=way, **point)
        try:
            found = run()
        except s2sad.S2sadError as error:
            if "S502" not in str(error):
                raise
            made.append({"by": point.get("rtol", point.get("steps")), "failed": error.diagnostics[0].message})
            continue
        taken = _seconds(run)
        taken = min([taken, *(_seconds(run) for _ in range(4 if taken < 0.5 else 0))])
        made.append({"by": point.get("rtol", point.get("steps")), "time": taken,
                     "error": float(np.max(np.abs(found - exact)) / np.max(np.abs(exact)))})
        if perf_counter() - start > MOST and way != "discrete":     # which has been compiled
            break
    return made


def _seconds(run: Callable[[], Any]) -> float:
    start = process_time()
    run()
    return process_time() - start


def render(found: dict[str, Any]) -> Chapter:
    table = Table("The least time to a gradient with at most this error", (
        "equation", "parameters", "state", *(f"{WAYS[way]}, {error:g}" for error in ERRORS for way in WAYS)))
    pictures = []
    for name, ways in found["equations"].items():
        equation = EQUATIONS[name]
        table.rows.append((name, str(equation.parameters.size), str(equation.state.size), *(
            _least(ways[way], error) for error in ERRORS for way in WAYS)))
        pictures.append(Picture(f"equations-{name}", f"{name}: time of a gradient against its error, by the three ways",
                                partial(_draw, name, ways)))
    failed = [f"{name}, {WAYS[way]}, {p['by']:g}: {p['failed']}" for name, ways in found["equations"].items()
              for way, points in ways.items() for p in points if "failed" in p]
    table.notes = [
        *([f"The integrator failed: {'; '.join(failed)}"] if failed else []),
        f"The load of the machine was {found['load']:.1f} on {found['cores']} cores when this was measured."]
    return Chapter(body=[
        "Gradients with respect to the parameters of a sum of squares at several times, by `s2sad.ode_gradient`. SciPy "
        "integrates with RK45, or BDF the stiff equations, of pollution and of the Brusselator; fixed steps are RK4's, "
        "or SDIRK4's. Errors are relative, of derivatives by relative changes of the parameters.",
        table, *pictures])


def _least(points: list[dict[str, Any]], error: float) -> str:
    times = [p["time"] for p in points if "failed" not in p and p["error"] <= error]
    return seconds(min(times)) if times else "none"


def _draw(name: str, ways: dict[str, list[dict[str, Any]]], figure: Any) -> None:
    axes = figure.subplots()
    equation = EQUATIONS[name]
    for way, all_points in ways.items():
        points = [p for p in all_points if "failed" not in p]
        by = equation.method if way == "discrete" else equation.integrator
        axes.loglog([p["error"] for p in points], [p["time"] for p in points], "o-", label=f"{WAYS[way]} ({by})")
    axes.set_xlabel("error of the gradient")
    axes.set_ylabel("seconds")
    axes.invert_xaxis()
    axes.legend()


SECTION = Section("equations", "Differential equations", measure, render, MINUTES)
