"""The command `s2sad`: derivatives of functions in files, without running these.

Exit status: 0; 1 for a refusal, with diagnostics on stderr, and for a check that fails; 2 for wrong usage.
"""
from __future__ import annotations

import argparse
import difflib
import gc
import os
import platform
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import metadata
from typing import Any

from s2sad import __version__, pipeline, read
from s2sad.binding import float_parameters
from s2sad.deep_stack import deep_stack
from s2sad.diagnostics import Diagnostic, Report, S2sadError
from s2sad.flattened.spelling import form_spelled, listed, named, spelled_out
from s2sad.infer.assumed import Assumed, assumed
from s2sad.program import Program, Request
from s2sad.report.argument_literals import evaluated, flat_values, form_of_literal
from s2sad.report.cache import cleared, described
from s2sad.report.explain import explained
from s2sad.report.made_up import checked_file
from s2sad.report.output import check_output, write_output
from s2sad.report.stages import ROOMS, STAGES, stages
from s2sad.run import store
from s2sad.run.compiled import chosen
from s2sad.structure import Form
from s2sad.tracebacks import internal
from s2sad.selection import selected_of, selected_wrt

_ABOUT = """\
Reads a NumPy function that loops and writes its arrays in place, and writes the Python source of its derivative.
The file is read, not run (only `s2sad check` runs it)."""
_EXAMPLES = """\
examples:
  s2sad adjoint kernel.py:step                       print the adjoint of step
  s2sad adjoint kernel.py:step --wrt u,p --of du -o step_adjoint.py --standalone
                                                     write it as a file that needs NumPy alone
  s2sad tangent kernel.py:step --types "u: float64[:, :], steps: int64"
  s2sad explain kernel.py:step --arguments "u=np.ones((512, 512)), steps=100"
                                                     what is recorded (how many MB), dropped, computed again, and why
  s2sad explain kernel.py:step --html -o step.html   the same as a page, the adjoint beside the function
  s2sad stages kernel.py:step --after normalize      the function after one pass of the compiler
  s2sad check kernel.py:step                         run it: tangent, adjoint and differences compared
  s2sad cache --clear                                remove what is kept on disk

types come from --types, else from the signature's annotations ("float64[:, :]", float, int), else from use: a
subscript of rank k or unpacking means a float64 array; use as a bound, an index or a shift int64; anything else
float64. The written file's header says what was assumed."""
_COMMANDS = {
    "adjoint": "write the adjoint (reverse mode): gradients of outputs with respect to inputs",
    "tangent": "write the tangent (forward mode): a directional derivative",
    "explain": "say what the adjoint records, leaves out and computes again, and where f is not differentiable",
    "stages": "print the function after the passes of the compiler",
    "check": "RUN the function and compare adjoint, tangent and differences",
    "cache": "say what is kept on disk for later processes, and where; or remove it",
}
_SHADOWS = """
a shadow (u_bar, u_dot) follows each float array; a tangent also follows each float number, whose adjoint is returned.
On entry u_bar holds the adjoint of what u is at the end, on exit of what it was at the start; for arrays that are only
read it is added to."""


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command; returns the exit status.

    >>> main(["adjoint", "nowhere.py:f"])
    1
    """
    parser, given = _parser(), sys.argv[1:] if argv is None else list(argv)
    if given and not given[0].startswith("-") and given[0] not in _COMMANDS:
        parser.error(_no_command(given[0]))
    options = parser.parse_args(given)
    if options.command is None:
        parser.print_help()
        return 2
    try:
        with _few_collections():
            return _cache(options) if options.command == "cache" else _run(parser, options)
    except S2sadError as refusal:
        print(refusal, file=sys.stderr)
        return 1
    except BrokenPipeError:
        sys.stderr.close()
        return 1
    except KeyboardInterrupt:
        return 130
    except Exception as error:
        print(internal(error), file=sys.stderr)
        return 1


@contextmanager
def _few_collections() -> Iterator[None]:
    """Trees have no cycles: the collector, which would go through all of them again and again, finds nothing there."""
    first, *others = gc.get_threshold()
    gc.set_threshold(first and max(first, 200_000), *others)
    try:
        yield
    finally:
        gc.set_threshold(first, *others)


@deep_stack
def _run(parser: argparse.ArgumentParser, options: argparse.Namespace) -> int:
    path, _, function = options.target.rpartition(":")
    if not path or not function.isidentifier():
        parser.error(_no_target(options))
    given = _given(parser, options.types or "")
    program = read.load_file(path, function)
    check_output(options.output, program.files)
    values = _values(program, options)
    program, request, found, paths = _request(parser, program, options, {
        **{name: form_of_literal(v) for name, v in values.items()}, **given})
    if options.command == "check":
        report = checked_file(path, function, options.arguments, found, request, paths)
        write_output(options.output, f"{report}\n")
        return 0 if report else 1
    if options.command == "explain":
        explanation = explained(program, request, flat_values(values, paths, program.kernels[program.entry]))
        text = explanation.json() + "\n" if options.json else explanation.html() if options.html else f"{explanation}\n"
    elif options.command == "stages":
        text = _stages(parser, program, request, options.after)
    else:
        made = pipeline.derive(program, request)
        for name in made.facts["independent"] if options.wrt else ():
            print(Diagnostic("S401", f"no output asked for of '{program.entry}' depends on '{name}': its gradient is "
                             "zero", severity="warning"), file=sys.stderr)
        text = made.text
    write_output(options.output, text)
    return 0


def _cache(options: argparse.Namespace) -> int:
    try:
        write_output(None, f"{store.location()}\n" if options.where else cleared() if options.clear else described())
    except RuntimeError as error:
        raise S2sadError(Diagnostic("S407", f"there is no cache: {error}",
                                    help="set S2SAD_CACHE_DIR to a folder of your own")) from None
    return 0


def _no_command(word: str) -> str:
    """What is said of a first word that is no command."""
    if ":" in word or word.endswith(".py"):
        return f"a command is missing: s2sad adjoint {word}"
    close = difflib.get_close_matches(word, _COMMANDS, 1)
    return f"there is no command '{word}'" + (f"; did you mean '{close[0]}'?" if close else
                                              f": the commands are {', '.join(_COMMANDS)}")


def _no_target(options: argparse.Namespace) -> str:
    """What is said of a target without a function: which there are in its file."""
    path, _, function = options.target.rpartition(":")
    path = path if path and not os.path.exists(options.target) else options.target.rstrip(":")
    if not os.path.exists(path) and not path.endswith(".py"):
        return f"'{options.target}' is not FILE:FUNCTION, as kernel.py:step"
    there = read.functions(path)
    if not there:
        return f"'{options.target}' names no function, and {path} defines none at module level"
    asked = "\n".join(f"  s2sad {options.command} {path}:{name}" for name in there)
    return f"'{options.target}' names no function at module level; {path} defines\n{asked}"


def _request(parser: argparse.ArgumentParser, program: Program, options: argparse.Namespace,
             given: dict[str, Form]) -> tuple[Program, Request, dict[str, Assumed], dict[str, str]]:
    """The program without structures, what is asked for, the types of its parameters by name, and the paths of these
    in structures."""
    kernel = program.kernels[program.entry]
    for name in given:
        if name not in kernel.parameters:
            parser.error(f"--types names '{name}', which is no parameter of '{program.entry}': its parameters are "
                         f"{', '.join(kernel.parameters)}")
    program, leaves, paths = spelled_out(program, given)
    kernel = program.kernels[program.entry]
    report = Report(kernel.source)
    found = assumed(program.entry, {n: k.tree for n, k in program.kernels.items()}, kernel.parameters,
                    kernel.annotations, kernel.defaults, leaves, report)
    report.finish()
    types = tuple(found[p].type for p in kernel.parameters)
    wrt, of = (named(_listed(names), paths) for names in (options.wrt, options.of))
    wrt = selected_wrt(program.entry, kernel.parameters, types, wrt)
    of = selected_of(program.entry, kernel.parameters, types, pipeline.summary(program, types), of)
    engine = chosen("auto") if options.engine == "auto" else options.engine
    mode = "tangent" if options.command == "tangent" else getattr(options, "mode", "adjoint")
    reasons = tuple((p, found[p].reason) for p in kernel.parameters if found[p].reason)
    request = Request(mode, types, wrt, of, engine, options.level, standalone=options.standalone, assumed=reasons)
    return program, request, found, paths


def _values(program: Program, options: argparse.Namespace) -> dict[str, Any]:
    """The arguments of `explain --arguments`, of which nothing is run."""
    if options.command != "explain" or options.arguments is None:
        return {}
    kernel = program.kernels[program.entry]
    return evaluated(options.arguments, kernel.parameters, float_parameters(kernel))


def _listed(names: str | None) -> tuple[str, ...] | None:
    return None if names is None else tuple(n.strip() for n in names.split(",") if n.strip())


def _given(parser: argparse.ArgumentParser, text: str) -> dict[str, Form]:
    """The types of `--types "u: float64[:, :], n: int64"`."""
    found: dict[str, Form] = {}
    for part in listed(text):
        name, colon, spelling = part.partition(":")
        if not colon or not name.strip().isidentifier():
            parser.error(f"--types: '{part.strip()}' is not NAME: TYPE, as u: float64[:, :]")
        kind = form_spelled(spelling)
        if kind is None:
            parser.error(f"--types: '{spelling.strip()}' is no type for '{name.strip()}'; use float64, float32, "
                         "complex128, int64 or bool, an array of these, as float64[:, :], or a structure, as "
                         "{u: float64[:], t: float}")
        found[name.strip()] = kind
    return found


def _stages(parser: argparse.ArgumentParser, program: Program, request: Request, after: str | None) -> str:
    stage = ROOMS.get(after or "", after)
    if stage is not None and stage not in STAGES:
        parser.error(f"there is no pass '{after}'; the passes are {', '.join(STAGES)}")
    texts = stages(program, request)
    if stage is not None:
        return texts[stage]
    shown, last = [], ""
    for name, text in texts.items():
        body = text.partition("\n")[2]
        shown.append(f"# ---- after {name} ----" + ("\n# (as before)\n" if body == last else f"\n{text}"))
        last = body
    return "\n".join(shown)


# -- arguments ------------------------------------------------------------------------------------------------------

def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("s2sad", description=_ABOUT, epilog=_EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--version", action="version", version=_version())
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")
    for command, about in _COMMANDS.items():
        lines = [line for line in _EXAMPLES.splitlines() if f"s2sad {command} " in line]
        epilog = "\n".join(["examples:", *lines]) + (_SHADOWS if command in ("adjoint", "tangent") else "")
        made = commands.add_parser(command, help=about, description=about[0].upper() + about[1:] + ".", epilog=epilog,
                                   formatter_class=argparse.RawDescriptionHelpFormatter)
        if command == "cache":
            what = made.add_mutually_exclusive_group()
            what.add_argument("--where", action="store_true", help="print its folder only")
            what.add_argument("--clear", action="store_true", help="remove what it holds")
        else:
            _add_options(made, command)
    return parser


def _version() -> str:
    found = [f"Python {platform.python_version()}"]
    for name in ("NumPy", "Numba"):
        with suppress(metadata.PackageNotFoundError):
            found.append(f"{name} {metadata.version(name.lower())}")
    return f"s2sad {__version__} ({', '.join(found)})"


def _add_options(parser: argparse.ArgumentParser, command: str) -> None:
    parser.add_argument("target", metavar="FILE:FUNCTION", help="a Python file and a function at its module level")
    parser.add_argument("--wrt", metavar="U,P", help="inputs to differentiate with respect to (default: all floats)")
    parser.add_argument("--of", metavar="DU", help='outputs: written arrays, "return" (default: all of them)')
    parser.add_argument("--types", metavar="TYPES", help='types of parameters, as "u: float64[:, :], steps: int64"')
    parser.add_argument("-o", "--output", metavar="OUT", help="the file to write (default: standard output)")
    parser.add_argument("--engine", choices=("numpy", "numba", "auto"),
                        default="auto" if command == "check" else "numpy",
                        help="what the text is written for: whole-array statements stay (numpy) or become loops "
                        "(numba); each text runs under both (default: %(default)s)")
    parser.add_argument("--level", choices=("plain", "fast"), default="plain",
                        help="statement by statement, or what runs (default: plain)")
    parser.set_defaults(standalone=False)
    if command in ("adjoint", "tangent", "stages"):
        parser.add_argument("--standalone", action="store_true", help="write a file that needs NumPy alone")
    if command == "explain":
        form = parser.add_mutually_exclusive_group()
        form.add_argument("--json", action="store_true", help="the facts as JSON")
        form.add_argument("--html", action="store_true", help="a page: the function and its adjoint side by side")
        parser.add_argument("--arguments", metavar="VALUES", help="sizes, for the bytes recorded, which are read "
                            'and not run: "u=np.ones((512, 512)), steps=100" or "u: float64[512, 512], steps: 100"')
    if command == "stages":
        parser.add_argument("--after", metavar="PASS", help=f"one of {', '.join(STAGES)}; or a room: "
                            f"{', '.join(ROOMS)} (default: all, one after the other)")
        parser.add_argument("--mode", choices=("adjoint", "tangent"), default="adjoint")
    if command == "check":
        parser.add_argument("--arguments", metavar="EXPR", help="the function's arguments as Python, with numpy as np: "
                            '"np.ones((4, 4)), 3" (default: made up from the types)')


if __name__ == "__main__":
    sys.exit(main())
