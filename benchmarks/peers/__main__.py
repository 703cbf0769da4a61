"""`python -m benchmarks peers [chapters...] [--quick] [--to FOLDER] [--redraw]` measures the chapters, all without a
name, stores what it finds, and writes `performance.md` with its pictures."""
from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from datetime import date
from pathlib import Path
from time import perf_counter

from benchmarks.peers.document import write
from benchmarks.peers.machine import machine
from benchmarks.peers.sections import MODULES, Section, section
from benchmarks.peers.tools import DISTRIBUTIONS
from s2sad.report.timing import on_one_core

ROOT = Path(__file__).resolve().parent.parent.parent
# XLA and torch allocate at every call: the C library keeps the memory, which is the best case for them
KEPT = {"MALLOC_ARENA_MAX": "1", "MALLOC_MMAP_THRESHOLD_": "1000000000", "MALLOC_TRIM_THRESHOLD_": "2000000000",
        "MALLOC_TOP_PAD_": "268435456"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Measures and writes; exit status 0 also where a chapter failed, which the document says."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks peers", description=__doc__)
    parser.add_argument("chapters", nargs="*", metavar="chapter", help=f"of {', '.join(MODULES)} (default: all)")
    parser.add_argument("--quick", action="store_true", help="few sizes and rounds: to see that it works, in a minute")
    parser.add_argument("--to", type=Path, help="folder of the document (default: docs; quick: a new temporary one)")
    parser.add_argument("--resume", action="store_true", help="measure only what the last run had no time for")
    parser.add_argument("--redraw", action="store_true", help="write the document from what is stored")
    options = parser.parse_args(arguments)
    unknown = [name for name in options.chapters if name not in MODULES]
    if unknown:
        parser.error(f"unknown: {', '.join(unknown)}; chapters are {', '.join(MODULES)}")
    to = options.to or (Path(tempfile.mkdtemp(prefix="performance-")) if options.quick else ROOT / "docs")
    folder = to.resolve() / "performance"
    folder.mkdir(parents=True, exist_ok=True)
    if options.resume:
        with on_one_core():
            for name in options.chapters or MODULES:
                resume(name, folder)
    elif not options.redraw:
        if not options.chapters or not (folder / "machine.json").exists():
            found = {"date": date.today().isoformat(), "quick": options.quick, "machine": machine(DISTRIBUTIONS)}
            (folder / "machine.json").write_text(json.dumps(found, indent=1))
        with on_one_core():
            for name in options.chapters or MODULES:
                if section(name) is not None:
                    measure(name, options.quick, folder)
    print(f"written: {write(folder)}")
    return 0


def measure(name: str, quick: bool, folder: Path) -> None:
    """Measures one chapter in a process of its own and stores what it returns, or why it failed."""
    found = section(name)
    assert found is not None
    path = folder / f"{name}.json"
    path.unlink(missing_ok=True)
    why = _stored(found, path, quick)
    if not path.exists():
        path.write_text(json.dumps({"failed": why}))


def resume(name: str, folder: Path) -> None:
    """Completes a chapter that ran out of time; one that is whole, failed or was not measured stays."""
    found, path = section(name), folder / f"{name}.json"
    stored = json.loads(path.read_text()) if path.exists() else {}
    if found is not None and found.resume is not None and stored.get("unreached"):
        _stored(found, path, quick=False)


def _stored(found: Section, path: Path, quick: bool) -> str:
    """Runs a chapter's process, which stores what it finds; gives why it does not."""
    start, name = perf_counter(), found.name
    command = [sys.executable, "-m", "benchmarks.peers.chapter", name, str(path), *["quick"] * quick]
    process = subprocess.Popen(command, env={**os.environ, **KEPT}, cwd=ROOT, start_new_session=True)
    status = None
    try:
        status = process.wait(60.0 * found.minutes)
        why = f"its process ended with status {status}"
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        why = f"it was stopped after {found.minutes:g} minutes"
    print(f"{name}: {perf_counter() - start:.0f} s{'' if status == 0 else ', failed: ' + why}", flush=True)
    return why


if __name__ == "__main__":
    raise SystemExit(main())
