"""bench: how long a function and its derivatives take and how wrong these are, beside differences and complex step."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from html import escape
from math import isnan
from time import perf_counter
from typing import Any

import numpy as np

from s2sad.interface.differentiate import differentiate
from s2sad.interface.drivers import gradient, vjp
from s2sad.interface.value_calls import ForwardCall, selection_of
from s2sad.program import Request
from s2sad.report.explain import Explanation, explain_program
from s2sad.report.output import check_output, write_output
from s2sad.report.picture import drawn, kind_of
from s2sad.report.measured_call import MeasuredCall
from s2sad.report.slopes import ReferenceSlopes, Slopes, reason
from s2sad.report.vector_function import split, vector_of
from s2sad.report.timing import Times, on_one_core, sampled, seconds
from s2sad.interface.selection import RETURN, ReturnedValues, Wrt
from s2sad.run.memory import byte_text
from s2sad.run.tracebacks import public

_STEPS, _FORWARD = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10), 1e-8
_COMPARED, _PATIENCE = 6, 20.0      # derivatives that are compared, and seconds that the reference may take about
_ORDER = ("primal", "adjoint, bare", "gradient", "vjp", "tangent", "complex step", "central difference",
          "forward difference")
_COLUMNS = ("run", "time", "quartiles", "over primal", "whole gradient", "error")


@dataclass(frozen=True)
class Run:
    """One way: its time, how many of its runs the whole gradient takes, and its error (None of the primal)."""
    name: str
    times: Times
    count: int = 0
    error: float | None = None

    @property
    def whole(self) -> float:
        """The seconds that the whole gradient takes."""
        return self.count * self.times.median


@dataclass(frozen=True)
class Bench:
    """The report: `str(it)` is a table, `it.picture("step.png")` draws run time against error; a notebook shows the
    table.

    `runs` has the primal first. Errors are the largest among `compared` of the `inputs` derivatives, as a fraction of
    the largest of these, and mean nothing below `floor`, the error of what they are measured against.
    """
    title: str
    runs: tuple[Run, ...]
    inputs: int
    compared: int
    floor: float
    remarks: tuple[str, ...]

    @property
    def primal(self) -> Times:
        return self.runs[0].times

    def rows(self) -> list[tuple[str, ...]]:
        """The table's rows as texts."""
        return [(r.name, str(r.times), f"{seconds(r.times.lower)} to {seconds(r.times.upper)}",
                 f"{r.times.median / self.primal.median:.2f}", seconds(r.whole) if r.count else "",
                 "" if r.error is None else self._error(r.error)) for r in self.runs]

    def _error(self, error: float) -> str:
        return "unknown" if isnan(error) else f"<= {self.floor:.1e}" if error < self.floor else f"{error:.1e}"

    def __str__(self) -> str:
        rows = [_COLUMNS, *self.rows()]
        widths = [max(len(row[k]) for row in rows) for k in range(len(_COLUMNS))]
        lines = ["  " + "  ".join(t.rjust(w) if k else t.ljust(w) for k, (t, w) in enumerate(zip(row, widths))).rstrip()
                 for row in rows]
        return "\n".join([self.title, *lines, *(f"  {r}" for r in self.remarks)])

    def _repr_html_(self) -> str:
        """What a notebook shows: the table."""
        head = "".join(f"<th>{escape(c)}</th>" for c in _COLUMNS)
        rows = "".join(f'<tr><td style="text-align: left">{escape(name)}</td>'
                       f"{''.join(f'<td>{escape(t)}</td>' for t in rest)}</tr>" for name, *rest in self.rows())
        return (f"<table><caption>{escape(self.title)}</caption><tr>{head}</tr>{rows}</table>"
                f"{''.join(f'<p>{escape(r)}</p>' for r in self.remarks)}")

    @public
    def picture(self, path: str) -> None:
        """Draws run time against error into a file (.png, .svg, .pdf); raises S2sadError: S405 without matplotlib,
        S407 where the file cannot be written."""
        kind = kind_of(path)
        check_output(path, ())
        write_output(path, drawn(self.title.partition(", engine")[0], self.runs, self.primal.median, self.floor, kind))


@public
def bench(f: Callable[..., Any], *args: Any, wrt: Wrt = None, of: str | Iterable[str] | None = None,
          engine: str | None = None, budget: float = 5.0) -> Bench:
    """How long f and its derivatives take at args, and how wrong these are; args are not changed.

    Args: args, f's arguments; wrt, of and engine as for `differentiate` (default: what f carries); budget, the seconds
    in which all runs are timed, in turns, on one core (each at least three times). The primal, the adjoint called bare
    and as `vjp` or `gradient` is called, the tangent, differences of several steps and the complex step, where f takes
    complex numbers. What takes one run for each input is timed for one, and the whole gradient is that many times as
    long. The report is a `Bench`.
    Raises S2sadError as `f.adjoint` does; and what f raises.
    Literature: Griewank and Walther, Evaluating Derivatives, SIAM 2008; Squire and Trapp, SIAM Review 40, 1998.

    >>> import numpy as np
    >>> def cubes(u):
    ...     total = 0.0
    ...     for i in range(u.size):
    ...         total += u[i] * u[i] * u[i]
    ...     return total
    >>> found = bench(cubes, np.ones(3), engine="numpy", budget=0.0)
    >>> [run.name for run in found.runs][:4], found.runs[1].error
    (['primal', 'adjoint, bare', 'gradient', 'tangent'], 0.0)
    """
    with on_one_core() as where:
        measured = MeasuredCall.for_call(f, args, wrt, of, engine)
        carried = selection_of(f)
        differentiated = differentiate(f, wrt=wrt if wrt is not None else carried.wrt,
                                       of=of if of is not None else carried.of,
                                       engine=measured.engine, checkpoint=carried.recording)
        return _Measurement(measured, differentiated, args, budget, where).made()


class _Measurement:
    def __init__(self, measured: MeasuredCall, differentiated: Any, args: tuple[Any, ...], budget: float, where: str):
        self.measured, self.differentiated, self.args = measured, differentiated, args
        self.budget, self.where = budget, where
        self.run = measured.primal(measured.values)
        self._outputs()     # what is compiled is compiled
        start, outputs = perf_counter(), self._outputs()
        patience = int(_PATIENCE / (60.0 * (perf_counter() - start)))
        self.seeds, self.user_call = self._seeds(outputs)
        self.reverse = measured.reverse()
        self.forward = measured.forward() if measured.has_tangent() else None
        gradients = self.reverse.vjp(measured.arguments, self.seeds)
        self.slopes = Slopes(measured, self.seeds, gradients, max(1, min(_COMPARED, patience)))

    def _outputs(self) -> dict[str, Any]:
        values = dict(zip(self.measured.values, self._copies()))
        values[RETURN] = self.run(*values.values())
        return {n: values[n] for n in self.measured.of}

    def _copies(self) -> list[Any]:
        return self.measured.state.with_private_copies(self.measured.arguments, self.measured.types)

    def _seeds(self, outputs: dict[str, Any]) -> tuple[dict[str, Any], tuple[str, Callable[[], Any]]]:
        """The seeds of the outputs, and the call as a user makes it, with its name."""
        measured, differentiated, args = self.measured, self.differentiated, self.args
        results = ReturnedValues.of(measured.state.summary(measured.types))
        if measured.of == (RETURN,) and len(results.types) == 1 and results.types[0].is_float \
                and not results.types[0].is_array:
            return {RETURN: 1.0}, ("gradient", partial(gradient(differentiated), *args))
        size = vector_of(outputs, measured.of).size
        seeds = split(outputs, measured.of, np.random.default_rng(0).standard_normal(size))
        if measured.structured:
            prepared = measured.reverse()
            return seeds, ("vjp", lambda: prepared.vjp(measured.arguments, seeds))
        return seeds, ("vjp", partial(vjp, differentiated, args, seeds))

    # -- what is timed -------------------------------------------------------------------------------------------------

    def made(self) -> Bench:
        candidates = {"primal": self._primal, "adjoint, bare": self._adjoint,
                      self.user_call[0]: lambda: self.user_call[1],
                      "central difference": partial(self._differences, 2),
                      "forward difference": partial(self._differences, 1)}
        found, remarks = {}, []
        if self.forward is None:
            remarks.append("no tangent: an adjoint of the user's own comes without one")
        else:
            candidates["tangent"] = partial(self._tangent, self.forward)
            found["tangent"] = self.slopes.tangent(self.forward)
        stepped = self._stepped(remarks)
        reference, right = self.slopes.reference([*found.values(), self.slopes.adjoint()], stepped)
        if stepped is not None and right:
            candidates["complex step"], found["complex step"] = self._complex_step, stepped
        elif stepped is not None:
            remarks.append("no complex step: differences do not confirm it, as with abs, or near a kink")
        times = {n: Times.of(t) for n, t in sampled(candidates, self.budget, least=3).items()}
        title = (f"Bench of {self.measured.title}, one thread{self.where}, {times['primal'].rounds} rounds in turns")
        return Bench(title, tuple(self._runs(times, reference, found)), self.slopes.size, self.slopes.places.size,
                     reference.floor, (*self._measure(reference), *remarks, *self._memory()))

    def _stepped(self, remarks: list[str]) -> np.ndarray | None:
        """The derivatives by the complex step; None where the kernel takes none."""
        try:
            return self.slopes.complex_step()
        except Exception as error:  # whatever the kernel raises for numbers that it was not written for
            remarks.append(f"no complex step: {reason(error)}")
            return None

    def _runs(self, times: dict[str, Times], reference: ReferenceSlopes, found: dict[str, np.ndarray]) -> Iterable[Run]:
        size, error = self.slopes.size, reference.error
        for name in sorted(times, key=_ORDER.index):
            taken = times[name]
            if name == "primal":
                yield Run(name, taken)
            elif name == "central difference":
                for step in _STEPS:
                    yield Run(f"{name}, step {step:.0e}", taken, size, error(self.slopes.central(step)))
            elif name == "forward difference":
                yield Run(f"{name}, step {_FORWARD:.0e}", taken, size, error(self.slopes.forward(_FORWARD)))
            elif name in found:
                yield Run(name, taken, size, error(found[name]))
            else:
                yield Run(name, taken, 1, error(self.slopes.adjoint()))

    def _primal(self) -> Callable[[], Any]:
        return self.measured.bare(dict(zip(self.measured.values, self._copies())))

    def _adjoint(self) -> Callable[[], Any]:
        values, shadows, seeds = self.reverse.bind_values(self.measured.arguments, self.seeds)
        return self._bare(self.reverse.rv, values, shadows, seeds)

    def _tangent(self, call: ForwardCall) -> Callable[[], Any]:
        x_dot = np.zeros(self.slopes.size)
        x_dot[self.slopes.places[:1]] = 1.0
        tangents = split(self.measured.values, self.measured.wrt, x_dot)
        return self._bare(call.fv, *call.bind_values(self.measured.arguments, tangents))

    def _bare(self, variant: Any, values: dict[str, Any], shadows: dict[str, Any], seeds: Sequence[Any] = ()
              ) -> Callable[[], Any]:
        outside = self.measured.state.private_outside_arrays(self.measured.types)
        return partial(variant.function, *variant.assemble(values, shadows, seeds, outside))

    def _differences(self, count: int) -> Callable[[], Any]:
        """The runs of the primal that one difference takes: two, or one beside the value that is known."""
        prepared = [self._primal() for _ in range(count)]
        return lambda: [run() for run in prepared]

    def _complex_step(self) -> Callable[[], Any]:
        return self.measured.bare(self.slopes.complex_values(int(self.slopes.places[0])))

    # -- what is said --------------------------------------------------------------------------------------------------

    def _measure(self, reference: ReferenceSlopes) -> list[str]:
        slopes = self.slopes
        some = f" {slopes.places.size} of" if slopes.places.size < slopes.size else ""
        of = f"the largest of{some} the {slopes.size} derivatives"
        single = ["differences and the complex step are taken in float64"] if self.measured.is_single_precision else []
        return [f"error: {of}, as a fraction of the largest; against {reference.source}", *single]

    def _memory(self) -> list[str]:
        """The bytes of the tape, of arguments and of shadows."""
        measured = self.measured
        request = Request("adjoint", measured.types, measured.wrt, measured.of, measured.engine,
                          recording=measured.recording)
        explanation: Explanation = explain_program(measured.state.program, request, measured.values)
        arrays = {n: v.nbytes for n, v in measured.values.items() if isinstance(v, np.ndarray)}
        shadows = sum(arrays.get(n, 0) for n in self.reverse.rv.shadows)
        taken = sum(arrays.values())
        known = 0 if explanation.tape == "nothing" else explanation.bytes
        total = f"; {byte_text(taken + shadows + known)} in all" if known is not None else ""
        return [f"memory: arrays {byte_text(taken)}, shadows {byte_text(shadows)}, recorded {explanation.tape}{total}"]
