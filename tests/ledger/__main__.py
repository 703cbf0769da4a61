"""The command: see the package's docstring."""
from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

from tests.ledger import __doc__ as description
from tests.ledger.compare import is_hash, compare
from tests.ledger.replay import Row, replay_all
from tests.ledger.store import Store


def main() -> int:
    parser = argparse.ArgumentParser("python -m tests.ledger", description=description,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    collect = commands.add_parser("collect", help="run tests, and add what they ask the compiler for")
    collect.add_argument("store")
    replay = commands.add_parser("replay", help="ask the package for all of it, and compare")
    replay.add_argument("store")
    replay.add_argument("--output", help="the file for the ledger; - for the terminal")
    replay.add_argument("--against", help="the ledger of another tree: print what moved, with status 1 if anything did")
    replay.add_argument("--sample", type=int, default=1, metavar="N", help="every N-th kernel")
    replay.add_argument("--jobs", type=int, help="processes (default: one for each core)")
    replay.add_argument("--slowest", type=int, default=5, metavar="N", help="print the N kernels that took longest")
    options, rest = parser.parse_known_args()
    if options.command == "replay" and rest:
        parser.error(f"unrecognized arguments: {' '.join(rest)}")
    return _collect(options.store, rest) if options.command == "collect" else _replay(options)


def _collect(path: str, arguments: list[str]) -> int:
    with tempfile.TemporaryDirectory() as folder:
        running = subprocess.Popen([sys.executable, "-m", "pytest", "-q", "-p", "tests.ledger.collect", "--tb=no",
                                    "--ledger-store", folder, "-p", "no:cacheprovider", *arguments])
        while running.returncode is None:
            with suppress(KeyboardInterrupt):       # pytest ends by itself then, and what it has is kept
                running.wait()
        store = Store.read(path) if Path(path).exists() else Store()
        for part in sorted(Path(folder).glob("*.store")):
            store.add(Store.read(str(part)))
        missed = {line for part in Path(folder).glob("*.missed") for line in part.read_text().splitlines()}
    store.write(path)
    for line in sorted(missed):
        print(f"not kept: {line}")
    print(f"{len(store.kernels)} kernels, {sum(len(k.asked) for k in store.kernels.values())} requests in {path}")
    return 0


def _replay(options: argparse.Namespace) -> int:
    rows, times = [], []
    for identity, found, seconds in replay_all(Store.read(options.store), options.sample, options.jobs):
        rows += found
        times.append((seconds, identity, found[0].name))
    text = "".join(sorted(f"{row}\n" for row in rows))
    if options.output == "-":
        sys.stdout.write(text)
    elif options.output:
        Path(options.output).write_text(text)
    accepted = sum(all(map(is_hash, row.cells)) for row in rows)
    print(f"{len(times)} kernels, {len(rows)} requests, {accepted} of them accepted under both engines")
    print(f"{sum(t for t, *_ in times):.1f} s of the processor in the compiler")
    for seconds, identity, name in sorted(times, reverse=True)[:options.slowest]:
        print(f"  {seconds:.2f} s  {identity} {name}")
    if not options.against:
        return 0
    wanted = {identity for _, identity, _ in times} if options.sample > 1 else None
    before = [Row.of(line) for line in Path(options.against).read_text().splitlines()]
    changes = compare((r for r in before if wanted is None or r.identity in wanted), rows)
    print(changes)
    return 1 if changes.kinds else 0


if __name__ == "__main__":
    sys.exit(main())
