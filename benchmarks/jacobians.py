"""Jacobians, batches of directions and products with Hessians: in calls of the compiled primal, in derivatives for one
direction and in gradients, taken in turns."""
from __future__ import annotations

import os
import tracemalloc
from dataclasses import asdict
from functools import partial
from importlib.util import find_spec
from statistics import median
from time import process_time
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import s2sad
from benchmarks.kernels.brusselator import brusselator
from benchmarks.kernels.cases import CASES, field
from benchmarks.peers.sections import Chapter, Section
from benchmarks.tables import Table
from s2sad.dispatch.cache import derivatives_of
from s2sad.interface.value_calls import ForwardCall

_LEAST = 2e-4       # seconds of a measurement


def in_turns(ways: dict[str, Any], rounds: int) -> dict[str, float]:
    """The median seconds of the processor that a call of each way takes, one after the other in each round."""
    taken: dict[str, list[float]] = {name: [] for name in ways}
    calls = {name: max(1, int(_LEAST / _seconds(way, 1))) for name, way in ways.items()}
    for _ in range(rounds):
        for name, way in ways.items():
            taken[name].append(_seconds(way, calls[name]))
    return {name: median(times) for name, times in taken.items()}


def _seconds(way: Any, calls: int) -> float:
    start = process_time()
    for _ in range(calls):
        way()
    return max((process_time() - start) / calls, 1e-9)


def tables(quick: bool, kernels: list[str]) -> list[Table]:
    """Jacobians, sparse and dense, what integrators make of them, directions at once, and products with Hessians."""
    sparse = Table("Sparse Jacobians of the Brusselator, in calls of its compiled primal",
                   ("n", "matrix", "products", "evaluation", "unchecked", "plan"),
                   [_of_the_brusselator(n, 10 if quick else 200) for n in (8, 32, 128)],
                   [] if quick else [_of_a_large_one()])
    dense = Table("The dense Jacobian of upwind, 401 x 401, in calls of its compiled primal",
                  ("directions at once", "Jacobian", "per batch", "per direction"), _of_upwind(5 if quick else 50),
                  [_of_upwind_sparse(5 if quick else 50)])
    kernels = ["upwind", "brusselator", "seidel", "advect", "jacobi"]
    several = Table("Eight directions at once (batch=True), in calls for one",
                    ("kernel", "tangents", "adjoints", "compiled tangents"),
                    [_at_once(name, 3 if quick else 20) for name in kernels],
                    ["Directions come and go along the first axis, and compiled functions have them along the last: "
                     "the last column is without that."])
    stiff = Table("The stiff Brusselator by solve_ivp(method=\"BDF\"), to t = 0.5",
                  ("n", "Jacobian", "time", "calls of f", "Jacobians", "factorizations"),
                  [row for n in ((8, 16) if quick else (16, 32, 64)) for row in _integrated(n, 1 if quick else 3)],
                  ["Nearly all of the time goes into factorizations, which are the same ones where SciPy knows the "
                   "pattern. Without it SciPy factors dense matrices, at n = 64 of 8192 rows."])
    hessian = Table("A product with the Hessian, in gradients", ("u", "gradient", "product", "ratio"),
                    [_with_the_hessian(n, 10 if quick else 100) for n in (100, 1000, 10_000)])
    bridges = Table("A call of a kernel of 100 numbers through another package, over the compiled one",
                    ("package", "value", "value over bare", "gradient", "gradient over bare", "target"), [
                        row for package, title, target, make in (
                            ("jax", "jax", "60 us", _in_jax), ("torch", "torch", "30 us", _in_torch),
                            ("torch", "torch, a Function that does nothing", "", _in_torch_alone))
                        for row in _bridged(package, title, target, make, 20 if quick else 200)])
    return [sparse, dense, several, stiff, hessian, *([bridges] if bridges.rows else [])]


def _of_upwind(rounds: int) -> list[tuple[str, ...]]:
    case = CASES["upwind"]
    args = case.arguments("large")
    f = s2sad.differentiate(case.function, engine="numba", wrt="u", of="du")
    primal = f.compiled("primal", *args)
    made: dict[int | str, Any] = {b: s2sad.jacobian(f, batch=b) for b in (1, 8, 16)}
    for J in made.values():
        J(*args)
    found = in_turns({"primal": lambda: primal(*args), **{
        str(b): lambda J=J: J(*args) for b, J in made.items()}}, rounds)
    unit = found.pop("primal")
    return [(b, f"{taken / unit:.0f}", f"{taken / unit / -(-args[1].size // int(b)):.1f}",
             f"{taken / unit / args[1].size:.1f}") for b, taken in found.items()]


def _of_upwind_sparse(rounds: int) -> str:
    """What the same Jacobian takes as a sparse matrix, once it is planned."""
    case = CASES["upwind"]
    args = case.arguments("large")
    f = s2sad.differentiate(case.function, engine="numba", wrt="u", of="du")
    made = {"checked": s2sad.jacobian(f, sparse=True), "unchecked": s2sad.jacobian(f, sparse=True, check=False)}
    for J in made.values():
        J(*args)
    found = in_turns({name: lambda J=J: J(*args) for name, J in made.items()}, rounds)
    return (f"As a sparse matrix, once it is planned: {1e6 * found['checked']:.0f} us, "
            f"{1e6 * found['unchecked']:.0f} us unchecked.")


def _of_a_large_one() -> str:
    """How time and memory grow up to n = 512."""
    made = []
    for n in (128, 512):
        u = field(n)
        args = np.zeros_like(u), u, np.array([3.4, 1.0, 10.0 * (n - 1) ** 2 / 961, 1.0 / n]), 0.0
        J = s2sad.jacobian(s2sad.differentiate(brusselator, engine="numba", wrt="u", of="du"), sparse=True)
        J(*args)
        tracemalloc.start()
        entries = J(*args).nnz
        memory = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        made.append((in_turns({"": lambda: J(*args)}, 5)[""] / entries, memory / entries))  # noqa: B023
    (little, bytes_of_it), (much, more) = made
    return (f"From n = 128 to 512, of sixteen times the entries, an evaluation takes {much / little:.2f} times the "
            f"time for each entry, and {more / bytes_of_it:.2f} times the memory ({more:.0f} bytes).")


def _at_once(name: str, rounds: int) -> tuple[str, ...]:
    """Both modes of a kernel, through `jvp` and `vjp` as users call them."""
    case, rng = CASES[name], np.random.default_rng(1)
    args = case.arguments("large")
    f = s2sad.differentiate(case.function, engine="numba")
    by_name = dict(zip(f.__wrapped_kernel__.__code__.co_varnames, args))
    wrt, of = case.wrt[0], case.of[0]
    along = rng.standard_normal((8, *np.shape(by_name[wrt])))
    weights = rng.standard_normal((8, *np.shape(by_name[of]))) if of != "return" else rng.standard_normal(8)
    one, seed = along[0].copy(), weights[0].copy() if weights.ndim > 1 else float(weights[0])
    ways = {"tangent": lambda: s2sad.jvp(f, args, {wrt: one}, of=(of,)),
            "tangents": lambda: s2sad.jvp(f, args, {wrt: along}, of=(of,), batch=True),
            "adjoint": lambda: s2sad.vjp(f, args, {of: seed}, wrt=wrt),
            "adjoints": lambda: s2sad.vjp(f, args, {of: weights}, wrt=wrt, batch=True)}
    for way in ways.values():
        way()
    ways |= _compiled(f, args, wrt, of)
    found = in_turns(ways, rounds)
    return name, *(f"{found[f'{mode}s'] / found[mode]:.1f}" for mode in ("tangent", "adjoint", "compiled tangent"))


def _compiled(f: Any, args: tuple[Any, ...], wrt: str, of: str) -> dict[str, Any]:
    """The compiled tangents for one direction and for eight, on arrays that lie as they have them."""
    call, made = ForwardCall(derivatives_of(f).state(), f, args, (wrt,), (of,)), {}
    values = dict(zip(call.names, call.private_copies(args, whole=True)))
    many = call.many(8)
    for title, derivative, lanes in (("compiled tangent", call.fv, ()), ("compiled tangents", many, (8,))):
        assert derivative is not None
        shadows = {n: np.ones((*np.shape(values[n]), *lanes)) if lanes or np.ndim(values[n]) else 1.0
                   for n in derivative.shadows}
        call.call(derivative, values, shadows)
        arguments = derivative.assemble(values, shadows, (), call.state.private_outside_arrays(call.types))
        made[title] = partial(derivative.call, *arguments)
    return made


def _integrated(n: int, rounds: int) -> list[tuple[str, ...]]:
    """The same integration with our Jacobian, with SciPy's differences of columns that share no row, and with its
    differences of single columns."""
    u, p = field(n), np.array([3.4, 1.0, 10.0 * (n - 1) ** 2 / 961, 1.0 / n])
    f = s2sad.differentiate(brusselator, engine="numba", wrt="u", of="du")
    du, primal, calls = np.zeros_like(u), f.compiled("primal", np.zeros_like(u), u, p, 0.0), [0]
    J = s2sad.jacobian(f, sparse=True)
    plan = J.plan(du, u, p, 0.0)
    pattern = plan.matrix(np.ones(len(plan.indices)))

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        calls[0] += 1
        made = np.empty_like(u)
        primal(made, y.reshape(u.shape), p, t)
        return made.reshape(-1)

    def solved(**how: Any) -> Any:
        calls[0] = 0
        solution = solve_ivp(rate, (0.0, 0.5), u.reshape(-1), method="BDF", rtol=1e-6, atol=1e-8, **how)
        return calls[0], solution.njev, solution.nlu

    how: dict[str, dict[str, Any]] = {"s2sad": {"jac": lambda t, y: J(du, y.reshape(u.shape), p, t)},
                                      "SciPy, with the pattern": {"jac_sparsity": pattern}}
    if n <= 32:
        how["SciPy"] = {}
    counts = {name: solved(**options) for name, options in how.items()}
    found = in_turns({name: lambda options=options: solved(**options) for name, options in how.items()}, rounds)
    return [(str(n), name, f"{1e3 * taken:.0f} ms", *map(str, counts[name])) for name, taken in found.items()]


def _of_the_brusselator(n: int, rounds: int) -> tuple[str, ...]:
    u = field(n)
    args = np.zeros_like(u), u, np.array([3.4, 1.0, 10.0 * (n - 1) ** 2 / 961, 1.0 / n]), 0.0
    f = s2sad.differentiate(brusselator, engine="numba", wrt="u", of="du")
    primal, J = f.compiled("primal", *args), s2sad.jacobian(f, sparse=True)
    unchecked, plan = s2sad.jacobian(f, sparse=True, check=False), J.plan(*args)
    unchecked(*args)
    found = in_turns({"primal": lambda: primal(*args), "checked": lambda: J(*args),
                      "unchecked": lambda: unchecked(*args)}, rounds)
    made = in_turns({"plan": lambda: J.plan(*args)}, 3)["plan"]
    return (str(n), f"{plan.shape[0]} x {plan.shape[1]}", str(plan.colors), *(
        f"{found[way] / found['primal']:.0f}" for way in ("checked", "unchecked")), f"{1e3 * made:.1f} ms")


def _with_the_hessian(n: int, rounds: int) -> tuple[str, ...]:
    u, v = np.linspace(0.5, 1.5, n), np.ones(n)
    f = s2sad.differentiate(_diffused, engine="numba", wrt="u")
    gradient = s2sad.gradient(f)
    found = in_turns({"gradient": lambda: gradient(u, 0.1, 20),
                      "product": lambda: s2sad.hvp(f, (u, 0.1, 20), {"u": v})}, rounds)
    return (str(n), *(f"{1e6 * found[way]:.0f} us" for way in ("gradient", "product")),
            f"{found['product'] / found['gradient']:.2f}")


def _bridged(package: str, title: str, target: str, make: Any, rounds: int) -> list[tuple[str, ...]]:
    """The value and the gradient of a sum through another package, beside the compiled functions; none without it."""
    if find_spec(package) is None:
        return []
    u = np.linspace(0.5, 1.5, 100)
    f = s2sad.differentiate(_summed, engine="numba", wrt="u")
    value, gradient = f.compiled("primal", u), f.compiled("adjoint", u, np.zeros(100), 1.0)
    bar = np.zeros(100)
    ways = {"bare": lambda: value(u), "bare gradient": lambda: gradient(u, bar, 1.0), **make(f, u)}
    for way in ways.values():
        way()
    found = {name: 1e6 * taken for name, taken in in_turns(ways, rounds).items()}
    over = [(found[name], found[name] - found[bare]) for name, bare in (("value", "bare"), (
        "gradient", "bare gradient"))]
    return [(title, *(f"{number:.0f} us" for pair in over for number in pair), target)]


def _in_jax(f: Any, u: np.ndarray) -> dict[str, Any]:
    import jax
    jax.config.update("jax_enable_x64", True)
    of = s2sad.jax(f)
    value, gradient, given = jax.jit(of), jax.jit(jax.grad(of)), jax.numpy.asarray(u)
    return {"value": lambda: value(given).block_until_ready(), "gradient": lambda: gradient(given).block_until_ready()}


def _in_torch(f: Any, u: np.ndarray) -> dict[str, Any]:
    return _by_torch(s2sad.torch(f), u)


def _in_torch_alone(f: Any, u: np.ndarray) -> dict[str, Any]:
    """What PyTorch takes for a step that has numbers ready."""
    import torch
    one = torch.tensor(1.0, dtype=torch.float64)

    class Nothing(torch.autograd.Function):
        @staticmethod
        def forward(given: Any) -> Any:
            return one.clone()

        @staticmethod
        def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
            ctx.save_for_backward(*inputs)

        @staticmethod
        def backward(ctx: Any, seed: Any) -> Any:
            return ctx.saved_tensors[0]
    return _by_torch(Nothing.apply, u)


def _by_torch(of: Any, u: np.ndarray) -> dict[str, Any]:
    import torch
    given, active = torch.from_numpy(u), torch.from_numpy(u.copy()).requires_grad_()

    def gradient() -> None:
        active.grad = None
        of(active).backward()
    return {"value": lambda: of(given), "gradient": gradient}


def _summed(u):
    total = 0.0
    for i in range(u.size):
        total += u[i] ** 3
    return total


def _diffused(u, dt, steps):
    v = u.copy()
    for _ in range(steps):
        for i in range(1, v.size - 1):
            v[i] = v[i] + dt * (v[i - 1] - 2.0 * v[i] + v[i + 1] + v[i] ** 2 - v[i] ** 3)
    return np.sum(v ** 2)


def measure(quick: bool) -> dict[str, Any]:
    """The tables, as plain data."""
    return {"load": os.getloadavg()[0], "tables": [asdict(table) for table in tables(quick, [])]}


def render(found: dict[str, Any]) -> Chapter:
    """The tables, and how busy the machine was."""
    made = [Table(t["title"], tuple(t["columns"]), [tuple(row) for row in t["rows"]], t["notes"])
            for t in found["tables"]]
    return Chapter(body=[
        "Under Numba, by batches of directions; sparse Jacobians with the check by one more direction and without it.",
        *made, f"The machine is shared: its load was {found['load']:.1f} on 2 cores when this was measured."])


SECTION = Section("jacobians", "Jacobians", measure, render, minutes=6)
