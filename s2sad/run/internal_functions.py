"""internal_functions: compiled functions that compiled code alone calls, as C's static functions.

Numba generates machine code for every function by itself, with all that it calls and with wrappers for Python, and
again in each function that calls it. An internal function is only linked into its callers: what Python calls is
optimized once, with all that it consists of. Short ones without loops are written out at their calls: LLVM leaves
functions of many numbers alone, as adjoints of helpers are, and computes again in them what their caller has.

LLVM asks before a loop which arrays overlap, and gives up vectors where that would be too many questions. Arrays of
functions that are never given memory twice are `noalias` to it, as C's `restrict` says.
"""
from __future__ import annotations

import ast
import ctypes
import importlib
from collections.abc import Iterator
from functools import lru_cache
from typing import Any

_PARTS = {"numba.core.codegen": ("JITCodeLibrary",), "numba.core.compiler": ("CompilerBase", "DefaultPassBuilder"),
          "numba.core.compiler_machinery": ("register_pass",), "numba.core.typed_passes": ("NativeLowering",),
          "numba._dynfunc": ("make_function",)}


DISTINCT = "__distinct__"        # in a module: the names of its functions that are never given memory twice
_LONGEST, _MOST = 1000, 8000     # nodes of one function that is written out, and of all its copies


def written_out(text: str) -> frozenset[str]:
    """The functions of a module that are written out where they are called, if they are internal.

    >>> sorted(written_out("def f(x):\\n    return x\\ndef g(x):\\n    for i in range(3):\\n        x[i] = f(x[i])"))
    ['f']
    """
    functions = [f for f in ast.parse(text).body if isinstance(f, ast.FunctionDef)]
    called = {f.name: [n.func.id for n in ast.walk(f) if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)]
              for f in functions}
    sizes: dict[str, int] = {}
    for function in functions:      # a function stands in front of those that call it
        size = sum(1 for _ in ast.walk(function)) + sum(sizes.get(c, 0) for c in called[function.name])
        calls = sum(those.count(function.name) for those in called.values())
        loops = any(isinstance(n, (ast.For, ast.While)) for n in ast.walk(function))
        if not loops and size <= _LONGEST and size * calls <= _MOST:
            sizes[function.name] = size
    return frozenset(sizes)


@lru_cache(maxsize=1)
def options() -> tuple[dict[str, Any], dict[str, Any]]:
    """The options of `njit` for functions that Python calls, and for internal ones; none under a Numba that does not
    have what this takes."""
    try:
        for module, names in _PARTS.items():
            for name in names:
                getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError):
        return {}, {}
    compiler = _compiler()
    called = {"no_cfunc_wrapper": True, "pipeline_class": compiler}
    return called, {**called, "no_cpython_wrapper": True}


def without_integer_literals(dispatcher: Any) -> Any:
    """A function that is compiled once for all integers that are written in its calls, and in tuples there: Numba has
    a type for each of them, and compiles it for each."""
    types, errors, given = (importlib.import_module("numba.core.types"), importlib.import_module("numba.core.errors"),
                            dispatcher.get_call_template)

    def plain(kind: Any) -> Any:
        if isinstance(kind, types.BaseTuple) and not isinstance(kind, types.BaseNamedTuple):
            return types.Tuple([plain(k) for k in kind])
        return types.unliteral(kind) if isinstance(kind, types.IntegerLiteral) else kind

    def get_call_template(args: Any, kws: Any) -> Any:
        wanted = tuple(map(plain, args))
        try:
            return given(wanted, kws)
        except errors.TypingError:
            if wanted == tuple(args):
                raise
            return given(args, kws)     # an axis, or the place of an item in a tuple
    dispatcher.get_call_template = get_call_template
    return dispatcher


def _compiler() -> type:
    """Numba's compiler with libraries that leave internal functions without machine code."""
    codegen, compiler, machinery, passes = (importlib.import_module(f"numba.{name}") for name in (
        "core.codegen", "core.compiler", "core.compiler_machinery", "core.typed_passes"))

    class Library(codegen.JITCodeLibrary):
        """The code of one function, with the environments of internal ones that are linked into it."""
        internal = False
        noalias: frozenset[str] = frozenset()       # names that LLVM has for the data of parameters

        def __init__(self, *arguments: Any):
            super().__init__(*arguments)
            self.environment: tuple[str, Any] | None = None

        def add_ir_module(self, ir_module: Any) -> None:
            for parameter in (p for f in ir_module.functions if not f.is_declaration for p in f.args):
                if parameter.name in self.noalias:
                    parameter.add_attribute("noalias")
            super().add_ir_module(ir_module)

        def _optimize_final_module(self) -> None:
            if not self.internal:
                super()._optimize_final_module()

        def _finalize_final_module(self) -> None:
            if self.internal:
                self._finalize_dynamic_globals()
                self._finalized = True
                return
            super()._finalize_final_module()
            for name, environment in self.linked_environments():
                if self._codegen._engine.is_symbol_defined(name):
                    self._codegen.set_env(name, environment)

        def linked_environments(self) -> Iterator[tuple[str, Any]]:
            """The environments of internal functions that are linked into this one, directly or not."""
            seen, waiting = set(), list(self._linking_libraries)
            while waiting:
                library = waiting.pop()
                if isinstance(library, Library) and library.internal and library not in seen:
                    seen.add(library)
                    waiting += library._linking_libraries
                    if library.environment is not None:
                        yield library.environment

    @machinery.register_pass(mutates_CFG=True, analysis_only=False)
    class Lowering(passes.NativeLowering):
        """Numba's, into such a library."""
        _name = "s2sad_native_lowering"

        def run_pass(self, state: Any) -> bool:
            library = state.library = Library(state.targetctx.codegen(), state.func_id.func_qualname)
            library.enable_object_caching()
            library.internal = state.flags.no_cpython_wrapper
            if state.func_id.func_name in state.func_id.func.__globals__.get(DISTINCT, ()):
                library.noalias = _data_of_arrays(state)
            if library.internal:
                state.targetctx = state.targetctx.subtarget(get_executable=_without_code(state.targetctx))
            return super().run_pass(state)

    class Compiler(compiler.CompilerBase):
        """Numba's passes with this one in place of its own."""

        def define_pipelines(self) -> list[Any]:
            made = compiler.DefaultPassBuilder.define_nopython_pipeline(self.state)
            made.passes = [(Lowering if each is passes.NativeLowering else each, title) for each, title in made.passes]
            made._finalized = False
            made.finalize()
            return [made]
    return Compiler


def _data_of_arrays(state: Any) -> frozenset[str]:
    """The names of the pointers to the data of a function's arrays."""
    array, models = importlib.import_module("numba.core.types").Array, state.targetctx.data_model_manager
    return frozenset(f"arg.{name}.{models[kind].get_field_position('data')}"
                     for name, kind in zip(state.func_ir.arg_names, state.args) if isinstance(kind, array))


def _without_code(context: Any) -> Any:
    """What gives Python a function that has no machine code: it raises TypeError. Its environment is for what calls
    it."""
    make = importlib.import_module("numba._dynfunc").make_function
    raising = ctypes.cast(ctypes.pythonapi.PyErr_BadArgument, ctypes.c_void_p).value

    def get_executable(library: Any, description: Any, environment: Any) -> Any:
        library.environment = context.get_env_name(description), environment
        return make(description.lookup_module(), description.qualname.rpartition(".")[2], "an internal function",
                    raising, environment, (library,))
    return get_executable
