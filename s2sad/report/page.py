"""page: the findings beside the source, as one HTML page that needs nothing else."""
from __future__ import annotations

from collections.abc import Iterable
from html import escape

from s2sad.report.findings import Findings, Place

_STYLE = """
:root { --line: #d8d8d8; --note: #555; --pushed: #fff2d6; --kinked: #fde4e4; --dropped: #f2f2f2; --again: #e6f0fb; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem; color: #1c1c1c; background: #fff; }
h1 { font-size: 1.3rem; } h2 { font-size: 1.05rem; margin-top: 2rem; font-family: ui-monospace, monospace; }
table { border-collapse: collapse; } td, th { padding: .1rem .7rem; text-align: left; vertical-align: top; }
table.facts { margin: .5rem 0 1rem; } table.facts td { border-bottom: 1px solid var(--line); }
table.source { width: 100%; table-layout: fixed; border: 1px solid var(--line); }
table.source td { font: 13px/1.5 ui-monospace, monospace; white-space: pre-wrap; overflow-wrap: anywhere; }
table.source td:first-child { width: 3rem; text-align: right; color: var(--note); user-select: none; }
table.source td:nth-child(2) { width: 60%; }
table.source td:last-child { font-family: system-ui, sans-serif; color: var(--note); }
tr.pushed td { background: var(--pushed); } tr.kinked td { background: var(--kinked); }
tr.dropped td { background: var(--dropped); } tr.again td { background: var(--again); }
.active { font-weight: 600; } .legend span { padding: 0 .5rem; margin-right: .5rem; }
"""
_LEGEND = (("pushed", "recorded"), ("kinked", "not differentiable"), ("again", "computed again"),
           ("dropped", "left out of the forward sweep"))


def page(title: str, functions: Iterable[Findings], sources: Iterable[tuple[str, str, int]]) -> str:
    """The page's text; `sources` are (path, text, number of the first line)."""
    functions = tuple(functions)
    legend = " ".join(f'<span style="background: var(--{key})">{words}</span>' for key, words in _LEGEND)
    body = [f"<h1>{escape(title)}</h1>", f'<p class="legend">{legend}</p>', *map(_facts, functions)]
    for path, text, first in sources:
        inside = [f for f in functions if f.path == path]
        body += [f"<h2>{escape(path)}</h2>", _source(text, first, _notes(inside))]
    return (f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{escape(title)}</title>\n'
            f"<style>{_STYLE}</style>\n</head>\n<body>\n" + "\n".join(body) + "\n</body>\n</html>\n")


def _facts(found: Findings) -> str:
    rows = [f"<tr><td{_bold(v.active)}>{escape(v.variable)}</td><td>{escape(v.type)}</td>"
            f"<td>{escape(v.reason)}</td></tr>" for v in found.variables]
    stacks = [f"<tr><td>{escape(s.name)}</td><td>{escape(s.what)}</td>"
              f"<td>{escape(s.size)}</td></tr>" for s in found.recorded]
    recorded = f'<table class="facts"><tr><th>recorded</th><th>what</th><th>size</th></tr>{"".join(stacks)}</table>' \
        if stacks else "<p>It records nothing.</p>"
    return (f"<h2>{escape(found.name)}</h2>\n<table class=\"facts\"><tr><th>variable</th><th>type</th><th>verdict</th>"
            f"</tr>{''.join(rows)}</table>\n{recorded}")


def _bold(active: bool) -> str:
    return ' class="active"' if active else ""


def _notes(functions: list[Findings]) -> dict[int, list[tuple[str, str]]]:
    """By line of the source: (kind, words)."""
    notes: dict[int, list[tuple[str, str]]] = {}

    def note(place: Place, kind: str, words: str) -> None:
        if not place.path and (kind, words) not in notes.setdefault(place.line, []):
            notes[place.line].append((kind, words))

    for found in functions:
        for stacked in found.recorded:
            note(stacked.place, "pushed", f"records {stacked.name}: {stacked.size}")
            for place in stacked.needed_by:
                note(place, "", f"needs {stacked.name}")
        for kink in found.kinks:
            note(kink.place, "kinked", f"not differentiable: {kink.what}")
        for again in found.again:
            note(again.place, "again", f"{again.variable} {again.how}")
        for place in found.dropped:
            note(place, "dropped", f"left out of the forward sweep of {found.name}")
        for place in found.loops:
            note(place, "", "run forward and back per iteration")
        for place in found.interpreted:
            note(place, "", "run by the interpreter, which Numba's code calls")
    return notes


def _source(text: str, first: int, notes: dict[int, list[tuple[str, str]]]) -> str:
    rows = []
    for number, line in enumerate(text.splitlines(), first):
        here = notes.get(number, [])
        kind = next((k for key, _ in _LEGEND for k, _ in here if k == key), "")
        words = "<br>".join(escape(w) for _, w in here)
        rows.append(f'<tr class="{kind}"><td>{number}</td><td>{escape(line)}</td><td>{words}</td></tr>')
    return f'<table class="source">{"".join(rows)}</table>'
