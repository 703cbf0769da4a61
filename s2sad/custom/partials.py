"""The partials of a user's rule: their trees, the functions that they call, and their values against differences."""
from __future__ import annotations

import builtins
import math
import sys
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from s2sad import tree
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.live_objects.registry import ROOM, imported
from s2sad.rules.rule import RESULT
from s2sad.tree import AST, Attribute, Call, Name

_LIBRARIES = {"numpy": "numpy", "np": "numpy", "math": "math"}
_POINTS = (0.137, 0.291, 0.449, 0.563, 0.718, 0.877)
_BUILTINS = ("abs", "float", "max", "min")


class Partials:
    """The partials of one function: `trees` by parameter, with resolved names, and the functions `called` by path."""

    def __init__(self, path: str, function: Any, parameters: tuple[str, ...], texts: Mapping[str, str]):
        self.path, self.function, self.parameters, self.texts = path, function, parameters, texts
        self.called: dict[str, Any] = {}
        self.values: dict[str, Any] = {}
        self.trees = {p: self._tree(p, texts[p]) for p in parameters}

    # -- names -------------------------------------------------------------------------------------------------------

    def _tree(self, parameter: str, text: str) -> AST:
        def change(node: AST) -> AST | None:
            if isinstance(node, (Name, Attribute)):
                return tree.name(self._resolved(parameter, node))
            if isinstance(node, Call) and node.keywords:
                raise self.wrong(f"the partial {parameter}={text!r} calls a function with keywords",
                                 "pass the arguments by position")
            return None
        try:
            return tree.rebuild(tree.expression(text), change)
        except SyntaxError:
            raise self.wrong(f"the partial {parameter}={text!r} is no expression") from None

    def _resolved(self, parameter: str, node: AST) -> str:
        """The name of a parameter, the result or a function, as trees have it."""
        path = dotted(node)
        root, _, rest = path.partition(".")
        if path in self.parameters or path == RESULT:
            return path
        if root in _LIBRARIES and rest and hasattr(sys.modules.get(_LIBRARIES[root], math), rest):
            return f"{_LIBRARIES[root]}.{rest}"
        home = self.path.rpartition(".")[0]
        if root == path and not hasattr(sys.modules.get(home), path) and path in _BUILTINS:
            return f"builtins.{path}"
        found = f"{home}.{path}" if root == path else path
        value = imported(found) if root else None
        if not callable(value):
            raise self.wrong(f"the partial {parameter}={self.texts[parameter]!r} reads {path or 'an attribute'}",
                             f"it may read {', '.join(self.parameters)} and {RESULT}, and call functions by their name")
        self.called[found] = value
        return ROOM + found

    # -- values ------------------------------------------------------------------------------------------------------

    def compare(self, domain: Mapping[str, tuple[float, float]]) -> None:
        """Raises S2sadError unless the partials are what differences say, at some points of the domain."""
        compared = 0
        for point in self._points(domain):
            value = self._value(point)
            if value is None or not math.isfinite(value):
                continue
            for parameter in self.parameters:
                slope = self._slope(point, parameter, value)
                if slope is None:
                    continue
                compared += 1
                stated = self._partial(parameter, {**point, RESULT: value})
                measured, error = slope
                if not abs(stated - measured) <= 1e-5 * max(abs(stated), abs(measured)) + 10 * error + 1e-8:
                    where = ", ".join(f"{p} = {x:.6g}" for p, x in point.items())
                    raise self.wrong(f"the partial {parameter}={self.texts[parameter]!r} is {stated:.6g} at {where}, "
                                     f"but differences give {measured:.6g}",
                                     "correct it, or say with domain= where it holds; check=False registers it "
                                     "unchecked")
        if not compared:
            raise self.wrong("nowhere on the domain could it be compared with differences",
                             "say where it is smooth, as domain={\"" + self.parameters[0] + "\": (0.5, 2.0)}")

    def _points(self, domain: Mapping[str, tuple[float, float]]) -> Iterator[dict[str, float]]:
        for k in range(len(_POINTS)):
            point = {}
            for n, parameter in enumerate(self.parameters):
                low, high = domain.get(parameter, (-2.0, 2.0))
                point[parameter] = low + _POINTS[(k + 2 * n + k * n) % len(_POINTS)] * (high - low)
            yield point

    def _value(self, point: Mapping[str, float]) -> float | None:
        """The function's value; None where it has none."""
        try:
            with np.errstate(all="ignore"):
                value = self.function(*point.values())
        except (ValueError, ArithmeticError):
            return None
        except Exception as error:
            raise self._uncalled(f"{type(error).__name__}: {error}") from None
        if not isinstance(value, (float, int, np.floating, np.integer)):
            raise self._uncalled(f"it returned {value!r}")
        return float(value)

    def _uncalled(self, note: str) -> S2sadError:
        count = len(self.parameters)
        message = f"rule for '{self.path}': it cannot be called with {count} float{'s' * (count > 1)}"
        return S2sadError(Diagnostic("S302", message, note=note, help="it must take floats and return a float; "
                                     "check=False registers the rule unchecked"))

    def _slope(self, point: Mapping[str, float], parameter: str, value: float) -> tuple[float, float] | None:
        """An extrapolated difference and an estimate of its error; None where it does not settle."""
        step = 1e-3 * max(abs(point[parameter]), 0.1)
        found = []
        for h in (step, step / 2, step / 4):
            ends = [self._value({**point, parameter: point[parameter] + s * h}) for s in (1, -1)]
            if any(e is None or not math.isfinite(e) for e in ends):
                return None
            found.append((float(ends[0] or 0.0) - float(ends[1] or 0.0)) / (2 * h))
        first, second = ((4 * b - a) / 3 for a, b in zip(found, found[1:]))
        error = abs(second - first) + 1e-14 * abs(value) / step
        return None if error > 1e-3 * (abs(second) + 1e-6) else (second, error)

    def _partial(self, parameter: str, values: Mapping[str, float]) -> float:
        space: dict[str, Any] = {"__builtins__": {n: getattr(builtins, n) for n in _BUILTINS}, "np": np, "numpy": np,
                                 "math": math}
        home = self.path.rpartition(".")[0]
        for path, value in self.called.items():
            module, _, last = path.rpartition(".")
            if module == home:
                space.setdefault(last, value)
            root = path.partition(".")[0]
            space.setdefault(root, sys.modules.get(root))
        try:
            with np.errstate(all="ignore"):
                return float(eval(self.texts[parameter], {**space, **values}))
        except ArithmeticError:
            return math.nan
        except Exception as error:
            raise self.wrong(f"the partial {parameter}={self.texts[parameter]!r} cannot be computed: "
                             f"{type(error).__name__}: {error}") from None

    def wrong(self, message: str, help: str = "") -> S2sadError:
        return S2sadError(Diagnostic("S302", f"rule for '{self.path}': {message}", help=help))


def dotted(node: AST) -> str:
    """`a.b.c`; empty for an attribute of anything but a name."""
    if isinstance(node, Name):
        return node.id
    base = dotted(node.value) if isinstance(node, Attribute) else ""
    return f"{base}.{node.attr}" if base else ""
