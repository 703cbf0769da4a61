"""The command `s2sad`: derivatives of functions in files, without running these.

Exit status: 0; 1 for a refusal, with diagnostics on stderr, and for a check that fails; 2 for wrong usage.
"""
from __future__ import annotations

import argparse
import difflib
import gc
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from s2sad import pipeline, read
from s2sad.dispatch.arguments import float_parameters
from s2sad.cli.parser import COMMANDS, RUNNING, command_parser
from s2sad.deep_stack import deep_stack
from s2sad.diagnostics import Diagnostic, S2sadError
from s2sad.infer.assumed_types import Assumed
from s2sad.interface.recording_arguments import recording_of
from s2sad.interface.pytrees.file_programs import Said, file_program, flat_spelled
from s2sad.interface.pytrees.spelled_types import flat_names, parse_form, split_list
from s2sad.program import Fact, Program, Recording, Request, Snapshots
from s2sad.report.argument_literals import evaluate_arguments, flat_values, form_of_literal
from s2sad.report.bench import bench
from s2sad.report.cache_contents import clear_cache, describe_cache
from s2sad.report.check import check
from s2sad.report.explain import explain_program
from s2sad.report.sample_arguments import run_on_file
from s2sad.report.output import check_output, write_output
from s2sad.report.picture import kind_of
from s2sad.report.stages import ROOMS, STAGES, stages
from s2sad.run import store
from s2sad.run.compiled import chosen
from s2sad.pytree import Form
from s2sad.run.tracebacks import internal
from s2sad.interface.selection import selected_of, selected_wrt


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command; returns the exit status.

    >>> main(["adjoint", "nowhere.py:f"])
    1
    """
    parser, arguments = command_parser(), sys.argv[1:] if argv is None else list(argv)
    if arguments and not arguments[0].startswith("-") and arguments[0] not in COMMANDS:
        parser.error(_no_command(arguments[0]))
    options = parser.parse_args(arguments)
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


def _run(parser: argparse.ArgumentParser, options: argparse.Namespace) -> int:
    path, _, function = options.target.rpartition(":")
    if not path or not function.isidentifier():
        parser.error(_no_target(options))
    types = _types_option(parser, options.types or "")
    program = file_program(path, function)
    check_output(options.output, program.files)
    check_output(getattr(options, "picture", None), program.files, "--picture")
    return _execute(program, parser, options, types)


@deep_stack
def _execute(program: Program, parser: argparse.ArgumentParser, options: argparse.Namespace,
             said: Said) -> int:
    """Runs the command on a program that has been read, and writes its output."""
    path, _, function = options.target.rpartition(":")
    values = _values(program, options)
    program, request, found, paths = _request(parser, program, options, Said({
        **{name: form_of_literal(v) for name, v in values.items()}, **said.forms}, said.facts))
    if options.command in RUNNING:
        return _run_file(path, function, options, found, request, paths)
    if options.command == "explain":
        explanation = explain_program(program, request, flat_values(values, paths, program.kernels[program.entry]))
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


def _run_file(path: str, function: str, options: argparse.Namespace, found: dict[str, Assumed], request: Request,
              paths: dict[str, str]) -> int:
    """The commands that run the file: `check` and `bench`."""
    if options.command == "check":
        report = run_on_file(check, path, function, options.arguments, found, request, paths)
        write_output(options.output, f"{report}\n")
        return 0 if report else 1
    if options.picture is not None:
        kind_of(options.picture)
    measured = run_on_file(bench, path, function, options.arguments, found, request, paths, budget=options.budget)
    write_output(options.output, f"{measured}\n")
    if options.picture is not None:
        measured.picture(options.picture)
    return 0


def _cache(options: argparse.Namespace) -> int:
    try:
        write_output(None, f"{store.location()}\n" if options.where
                     else clear_cache() if options.clear else describe_cache())
    except RuntimeError as error:
        raise S2sadError(Diagnostic("S407", f"there is no cache: {error}",
                                    help="set S2SAD_CACHE_DIR to a folder of your own")) from None
    return 0


def _no_command(word: str) -> str:
    """The message for a first word that is no command."""
    if ":" in word or word.endswith(".py"):
        return f"a command is missing: s2sad adjoint {word}"
    close = difflib.get_close_matches(word, COMMANDS, 1)
    return f"there is no command '{word}'" + (f"; did you mean '{close[0]}'?" if close else
                                              f": the commands are {', '.join(COMMANDS)}")


def _no_target(options: argparse.Namespace) -> str:
    """The message for a target without a function: the functions of its file."""
    path, _, function = options.target.rpartition(":")
    path = path if path and not os.path.exists(options.target) else options.target.rstrip(":")
    if not os.path.exists(path) and not path.endswith(".py"):
        return f"'{options.target}' is not FILE:FUNCTION, as kernel.py:step"
    there = read.functions(path)
    if not there:
        return f"'{options.target}' names no function, and {path} defines none at module level"
    commands = "\n".join(f"  s2sad {options.command} {path}:{name}" for name in there)
    return f"'{options.target}' names no function at module level; {path} defines\n{commands}"


def _request(parser: argparse.ArgumentParser, program: Program, options: argparse.Namespace,
             said: Said) -> tuple[Program, Request, dict[str, Assumed], dict[str, str]]:
    """The program without structures, the request, the types of its parameters by name, and the paths of these in
    structures."""
    kernel = program.kernels[program.entry]
    for name in said.forms:
        if name not in kernel.parameters:
            parser.error(f"--types names '{name}', which is no parameter of '{program.entry}': its parameters are "
                         f"{', '.join(kernel.parameters)}")
    program, found, paths = flat_spelled(program, said)
    kernel = program.kernels[program.entry]
    types = tuple(found[p].type for p in kernel.parameters)
    wrt, of = (flat_names(_listed(names), paths) for names in (options.wrt, options.of))
    wrt = selected_wrt(program.entry, kernel.parameters, types, wrt)
    of = selected_of(program.entry, kernel.parameters, types, pipeline.summary(program, types), of)
    engine = chosen("auto") if options.engine == "auto" else options.engine
    mode = "tangent" if options.command == "tangent" else getattr(options, "mode", "adjoint")
    reasons = tuple((p, found[p].reason) for p in kernel.parameters if found[p].reason)
    request = Request(mode, types, wrt, of, engine, options.level, standalone=options.standalone, assumed=reasons,
                      recording=_recording_options(parser, options), split=options.split)
    return program, request, found, paths


def _values(program: Program, options: argparse.Namespace) -> dict[str, Any]:
    """The arguments of `explain --arguments`, of which nothing is run."""
    if options.command != "explain" or options.arguments is None:
        return {}
    kernel = program.kernels[program.entry]
    return evaluate_arguments(options.arguments, kernel.parameters, float_parameters(kernel))


def _listed(names: str | None) -> tuple[str, ...] | None:
    return None if names is None else tuple(n.strip() for n in names.split(",") if n.strip())


def _recording_options(parser: argparse.ArgumentParser, options: argparse.Namespace) -> Recording:
    """What `--memory`, `--tape-dtype` and `--checkpoint "k=20, advance.k=10@/scratch"` say, or `"1 GB"`."""
    text, found = options.checkpoint, {}
    if text is not None and "=" not in text and text.strip()[:1].isdecimal():
        return recording_of(int(text) if text.strip().isdecimal() else text, options.memory, options.tape_dtype)
    for part in _listed(text) or ():
        loop, sign, snapshots = part.partition("=")
        count, disk, folder = snapshots.partition("@")
        if not sign or not count.strip().isdecimal() or disk and not folder.strip():
            parser.error(f"--checkpoint: '{part}' is not LOOP=NUMBER or LOOP=NUMBER@FOLDER, as k=20, advance.k=20, "
                         "line 14=20 or k=20@/scratch")
        found[loop.strip()] = Snapshots(int(count), folder.strip() or None)
    return recording_of(found, options.memory, options.tape_dtype)


def _types_option(parser: argparse.ArgumentParser, text: str) -> Said:
    """What `--types "u: float64[:, :], n: int64, order: 2"` says."""
    found: dict[str, Form] = {}
    facts: dict[Fact, Any] = {}
    for part in split_list(text):
        name, colon, spelling = part.partition(":")
        if not colon or not name.strip().isidentifier():
            parser.error(f"--types: '{part.strip()}' is not NAME: TYPE, as u: float64[:, :]")
        kind = parse_form(spelling, name.strip(), facts)
        if kind is None:
            parser.error(f"--types: '{spelling.strip()}' is no type for '{name.strip()}'; use float64, float32, "
                         "complex128, int64 or bool, an array of these, as float64[:, :], or a structure, as "
                         "{u: float64[:], t: float}")
        found[name.strip()] = kind
    return Said(found, facts)


def _stages(parser: argparse.ArgumentParser, program: Program, request: Request, after: str | None) -> str:
    stage = ROOMS.get(after or "", after)
    if stage is not None and stage not in STAGES:
        parser.error(f"there is no pass '{after}'; the passes are {', '.join(STAGES)}, and what ends with one: "
                     f"{', '.join(ROOMS)}")
    texts = stages(program, request)
    if stage is not None:
        return texts[stage]
    shown, last = [], ""
    for name, text in texts.items():
        body = text.partition("\n")[2]
        shown.append(f"# ---- after {name} ----" + ("\n# (as before)\n" if body == last else f"\n{text}"))
        last = body
    return "\n".join(shown)


if __name__ == "__main__":
    sys.exit(main())
