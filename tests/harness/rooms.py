"""The picture of the rooms, drawn from the code: `python -m tests.harness.rooms` writes docs/rooms.svg, and prints the
table of the rooms.

The rooms stand in the order of the import contract in pyproject.toml; an arc leads from a room to each room below that
it imports, unless another arc already says so (transitive reduction).
"""
from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape

from tests.harness.documents import ROOT

PICTURE = ROOT / "docs" / "rooms.svg"
PACKAGE = ROOT / "s2sad"
LINE, TOP, ARCS = 27, 20, 700      # pixels: height of a room's line, margin, where arcs begin


@dataclass(frozen=True)
class Room:
    """A folder or a module of the package: its files and lines, its first sentence, and the rooms that it imports."""
    name: str
    files: int
    lines: int
    sentence: str
    imports: frozenset[str]


def layers() -> list[list[str]]:
    """The rooms of the import contract, from the top."""
    contract = (ROOT / "pyproject.toml").read_text(encoding="utf-8").split('name = "Imports point upstream"')[1]
    rows = re.findall(r'^    "([^"]*)",$', contract.split("layers = [")[1].split("\n]")[0], re.M)
    return [[room.strip(" ()") for room in re.split(r"[|:]", row)] for row in rows]


def room(name: str) -> Room:
    """What the code says of a room."""
    folder = PACKAGE / name
    files = sorted(folder.rglob("*.py")) if folder.is_dir() else [folder.with_suffix(".py")]
    trees = [ast.parse(f.read_text(encoding="utf-8")) for f in files]
    first = ast.parse((folder / "__init__.py" if folder.is_dir() else files[0]).read_text(encoding="utf-8"))
    said = " ".join((ast.get_docstring(first) or "").split())
    said = re.sub(rf"^(The )?{name.rpartition('/')[2]}: ", "", said, flags=re.I)
    sentence = re.split(r"(?<=[.:;]) ", said)[0]
    return Room(name, len(files), sum(len(f.read_text(encoding="utf-8").splitlines()) for f in files),
                sentence.rstrip(".:;"), frozenset(n for tree in trees for n in imported(tree) if n != name))


def imported(tree: ast.AST) -> set[str]:
    """The rooms that a module imports, wherever it does."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "s2sad":
            inner = (node.module or "").split(".")[1:2]
            found |= set(inner) if inner else {alias.name for alias in node.names}
        elif isinstance(node, ast.Import):
            found |= {a.name.split(".")[1] for a in node.names if a.name.startswith("s2sad.")}
    return found


def reduced(edges: Mapping[str, frozenset[str]]) -> dict[str, set[str]]:
    """The edges without those that follow from others; there are no cycles."""
    below: dict[str, set[str]] = {}

    def reach(name: str) -> set[str]:
        if name not in below:
            below[name] = set(edges[name]).union(*map(reach, edges[name]))
        return below[name]
    return {a: {b for b in targets if not any(b in reach(c) for c in targets if c != b)}
            for a, targets in edges.items()}


def rooms() -> list[Room]:
    """Every room of the contract, in its order, each with the rooms inside it behind it."""
    found = []
    for name in (name for row in layers() for name in row):
        inner = sorted(p.relative_to(PACKAGE).as_posix() for p in (PACKAGE / name).rglob("*")
                       if (p / "__init__.py").is_file())
        found += [room(n) for n in (name, *inner)]
    return found


def picture(found: list[Room]) -> str:
    """The rooms as SVG."""
    place = {r.name: TOP + LINE * k for k, r in enumerate(found)}
    edges = reduced({r.name: frozenset(n for n in r.imports if n in place and place[n] > place[r.name])
                     for r in found})
    widest = max(place[b] - place[a] for a, targets in edges.items() for b in targets)
    width, height = ARCS + widest // 3 + 40, 2 * TOP + LINE * len(found)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif">',
           f'<rect width="{width}" height="{height}" fill="white"/>']
    for r in found:
        y = place[r.name]
        x = 10 + 24 * r.name.count("/")
        title = r.name.rpartition("/")[2] + "/" * (r.files > 1)
        out += [f'<rect x="{x}" y="{y}" width="{ARCS - 10 - x}" height="{LINE - 4}" rx="4" fill="#eef2f7"/>',
                f'<text x="{x + 10}" y="{y + 16}" font-size="13" font-weight="bold">{title}</text>',
                f'<text x="{x + 150}" y="{y + 16}" font-size="11">{escape(_short(r.sentence))}</text>']
    for a in edges:
        for b in sorted(edges[a]):
            start, end = place[a] + LINE // 2, place[b] + LINE // 2 - 6
            bend = ARCS + (end - start) // 3 + 20
            out.append(f'<path d="M {ARCS - 8} {start} Q {bend} {(start + end) // 2} {ARCS - 8} {end}" fill="none" '
                       f'stroke="#4a6fa5" stroke-width="1.2"/>')
            out.append(f'<path d="M {ARCS - 8} {end} l 7 -5 l 1 6 z" fill="#4a6fa5"/>')
    return "\n".join([*out, "</svg>", ""])


def _short(sentence: str, most: int = 90) -> str:
    return sentence if len(sentence) <= most else sentence[:most].rsplit(" ", 1)[0] + " ..."


def main() -> None:
    found = rooms()
    PICTURE.write_text(picture(found), encoding="utf-8")
    for r in found:
        print(f"{r.name:20} {r.files:4} files {r.lines:7,} lines   {r.sentence}")
    whole = [r for r in found if "/" not in r.name]
    print(f"{len(layers())} layers, {sum(r.files for r in whole)} files, {sum(r.lines for r in whole):,} lines")


if __name__ == "__main__":
    main()
