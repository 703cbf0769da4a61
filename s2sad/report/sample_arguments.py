"""`check` and `bench` of a function of a file: it is run, without arguments of the user's on sample arguments."""
from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np

from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.infer.assumed_types import Assumed
from s2sad.interface.differentiate import differentiate
from s2sad.program import Recording, Request

_SIZE = 6


Answer = TypeVar("Answer")


def run_on_file(verb: Callable[..., Answer], path: str, function: str, arguments: str | None,
                found: Mapping[str, Assumed], request: Request, paths: Mapping[str, str],
                **options: Any) -> Answer:
    """Runs the file, then a verb, as `check`, with its options on one of its functions; raises S2sadError where either
    cannot be done."""
    if arguments is None and any(name != path for name, path in paths.items()):
        raise S2sadError(Diagnostic("S405", f"'{function}' takes structures, and none can be made up",
                                    help="give its arguments as Python, in --arguments, or call "
                                    f"s2sad.{verb.__name__}"))
    kernel = _imported(path, function)
    if request.recording != Recording():
        kernel = differentiate(kernel, checkpoint=request.recording)
    wrt, of = ([paths.get(n, n) for n in names] for names in (request.wrt, request.of))
    if arguments is None:
        values: tuple[Any, ...] = tuple(sample_argument(a) for a in found.values())
        print(f"running {path} and {function} on made-up arguments (give yours with --arguments)", file=sys.stderr)
    else:
        print(f"running {path} and {function}", file=sys.stderr)
        values = _evaluated(arguments)
    try:
        return verb(kernel, *values, wrt=wrt, of=of, engine=request.engine, **options)
    except S2sadError:
        raise
    except Exception as error:
        said = "" if arguments is not None else " on made-up arguments"
        raise S2sadError(Diagnostic("S405", f"'{function}' raised {type(error).__name__}{said}: {error}",
                                    help='give arguments that fit: --arguments "np.ones((4, 4)), 3"')) from error


def sample_argument(assumed: Assumed, seed: int = 0) -> Any:
    """An argument of a type: arrays with axes of 6 (or as many as they are unpacked into), integers 3.

    >>> from s2sad.infer.types import FLOAT, INT, array
    >>> sample_argument(Assumed(INT)), sample_argument(Assumed(array("float64", 2))).shape
    (3, (6, 6))
    """
    kind, rng = assumed.type, np.random.default_rng(seed)
    extents = dict(assumed.extents)
    shape = tuple(extents.get(k, _SIZE) for k in range(kind.rank))
    if kind.is_float:
        values = 0.5 + rng.random(shape)
        return values.astype(kind.dtype) if kind.is_array else float(values)
    if kind.is_complex:
        values = 0.5 + rng.random(shape) + 1j * rng.random(shape)
        return values if kind.is_array else complex(values)
    if kind.dtype == "bool":
        return rng.random(shape) < 0.5 if kind.is_array else True
    if kind.is_array:
        return np.sort(rng.integers(0, _SIZE, shape)).astype(kind.dtype)
    return 3 if kind.is_number else None


def _imported(path: str, function: str) -> Callable[..., Any]:
    """The function of the file, which is run."""
    folder = os.path.dirname(os.path.abspath(path))
    if folder not in sys.path:
        sys.path.insert(0, folder)
    title = os.path.splitext(os.path.basename(path))[0]
    spec = importlib.util.spec_from_file_location(title, path)
    if spec is None or spec.loader is None:
        raise S2sadError(Diagnostic("S101", f"{path}: cannot be run", help="give a file that ends in .py"))
    module = importlib.util.module_from_spec(spec)
    sys.modules.setdefault(title, module)
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise S2sadError(Diagnostic("S101", f"{path}: raised {type(error).__name__} when it was run: {error}",
                                    help="make sure that the file can be imported")) from error
    return getattr(module, function)


def _evaluated(text: str) -> tuple[Any, ...]:
    try:
        found = eval(f"({text},)", {"np": np, "numpy": np})  # the user's own expression, on the user's own machine
    except Exception as error:
        raise S2sadError(Diagnostic("S405", f"--arguments: {type(error).__name__}: {error}",
                                    help='give Python, as --arguments "np.ones((4, 4)), 3"')) from error
    return tuple(found)
