"""The options of the command `s2sad`, and its help."""
from __future__ import annotations

import argparse
import platform
from contextlib import suppress
from importlib import metadata

from s2sad import __version__
from s2sad.interface.recording_arguments import ECONOMIES, TAPE_DTYPES
from s2sad.report.stages import ROOMS

_ABOUT = """\
Reads a NumPy function that loops and writes its arrays in place, and writes the Python source of its derivative.
The file is read, not run (only `s2sad check` and `s2sad bench` run it)."""
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
  s2sad bench kernel.py:step --picture step.png      run it: times and errors of primal, adjoint, tangent, differences
  s2sad cache --clear                                remove what is kept on disk

types come from --types, else from the signature's annotations ("float64[:, :]", float, int), else from use: a
subscript of rank k or unpacking means a float64 array; use as a bound, an index or a shift int64; anything else
float64. The written file's header says what was assumed."""
COMMANDS = {
    "adjoint": "write the adjoint (reverse mode): gradients of outputs with respect to inputs",
    "tangent": "write the tangent (forward mode): a directional derivative",
    "explain": "say what the adjoint records, leaves out and computes again, and where f is not differentiable",
    "stages": "print the function after the passes of the compiler",
    "check": "RUN the function and compare adjoint, tangent and differences",
    "bench": "RUN the function and measure time and error of adjoint, tangent, differences and complex step",
    "cache": "say what is kept on disk for later processes, and where; or remove it",
}
RUNNING = ("check", "bench")
_SHADOWS = """
a shadow (u_bar, u_dot) follows each float array; a tangent also follows each float number, whose adjoint is returned.
On entry u_bar holds the adjoint of what u is at the end, on exit of what it was at the start; for arrays that are only
read it is added to."""


def command_parser() -> argparse.ArgumentParser:
    """The commands with their options and what they say of themselves."""
    parser = argparse.ArgumentParser("s2sad", description=_ABOUT, epilog=_EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--version", action="version", version=_version())
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")
    for command, about in COMMANDS.items():
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
                        default="auto" if command in RUNNING else "numpy",
                        help="what the text is written for: whole-array statements stay (numpy) or become loops "
                        "(numba); each text runs under both (default: %(default)s)")
    parser.add_argument("--level", choices=("plain", "fast"), default="plain",
                        help="statement by statement, or what runs (default: plain)")
    parser.set_defaults(standalone=False, checkpoint=None, memory=None, tape_dtype=None, split=False)
    if command == "adjoint":
        parser.add_argument("--split", action="store_true", help="two functions: the augmented primal, which gives the "
                            "tape, and the reverse sweep, which takes it")
    if command in ("adjoint", "explain", "stages", *RUNNING):
        parser.add_argument("--checkpoint", metavar="K=20", help='loops that keep snapshots in place of a tape, and '
                            'how many: "k=20, advance.k=10, line 14=20"; in files of a folder: '
                            '"k=20@/scratch"; or a limit, "1 GB", where sizes are known: check, bench, explain '
                            "--arguments")
        parser.add_argument("--memory", choices=ECONOMIES, help="what counts where memory costs time (default: "
                            "balanced)")
        parser.add_argument("--tape-dtype", choices=TAPE_DTYPES, help="in what floats of double precision are recorded "
                            "(default: float64)")
    if command in ("adjoint", "tangent", "stages"):
        parser.add_argument("--standalone", action="store_true", help="write a file that needs NumPy alone")
    if command == "explain":
        form = parser.add_mutually_exclusive_group()
        form.add_argument("--json", action="store_true", help="the facts as JSON")
        form.add_argument("--html", action="store_true", help="a page: the function and its adjoint side by side")
        parser.add_argument("--arguments", metavar="VALUES", help="sizes, for the bytes recorded, which are read "
                            'and not run: "u=np.ones((512, 512)), steps=100" or "u: float64[512, 512], steps: 100"')
    if command == "stages":
        parser.add_argument("--after", metavar="PASS", help="a pass, or what ends with one: "
                            f"{', '.join(ROOMS)} (default: all passes, one after the other)")
        parser.add_argument("--mode", choices=("adjoint", "tangent"), default="adjoint")
    if command in RUNNING:
        parser.add_argument("--arguments", metavar="EXPR", help="the function's arguments as Python, with numpy as np: "
                            '"np.ones((4, 4)), 3" (default: made up from the types)')
    if command == "bench":
        parser.add_argument("--picture", metavar="FILE", help="draw run time against error (.png, .svg, .pdf); needs "
                            "the extra plot")
        parser.add_argument("--budget", metavar="SECONDS", type=float, default=5.0,
                            help="how long is measured (default: %(default)g)")
