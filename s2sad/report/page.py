"""page: the functions and their derivatives side by side, as one HTML page that needs nothing else.

The page is `page.html` with the title, the text of the report (for browsers without scripts) and the facts as JSON;
what it looks like and does stands there.
"""
from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from functools import cache
from html import escape
from importlib.resources import files
from typing import Any

from s2sad.report.findings import Findings, FoundPlace
from s2sad.report.listing import Listing
from s2sad.run.memory import byte_text

_PLACEHOLDER = re.compile("@(title|text|data)@")


def page(title: str, tape: str, text: str, functions: Iterable[Findings], listings: Sequence[Listing]) -> str:
    """The page's text; `tape` says how much is recorded, `text` is the whole report."""
    found = {f.name: f for f in functions}
    data = {"title": title, "tape": tape, "functions": [_function(each, found.get(each.name)) for each in listings]}
    parts = {"title": escape(title), "text": escape(text), "data": _embedded(data)}
    return _PLACEHOLDER.sub(lambda match: parts[match[1]], _template())


@cache
def _template() -> str:
    return files("s2sad.report").joinpath("page.html").read_text(encoding="utf-8")


def _embedded(data: Any) -> str:
    """JSON that stands in a script element: nothing in it ends that, or is anything but ASCII."""
    text = json.dumps(data, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _function(listing: Listing, found: Findings | None) -> dict[str, Any]:
    return {
        "name": listing.name, "kernel": listing.kernel, "active": listing.active,
        "sources": [{"name": s.name, "path": s.path, "lines": [
            {"number": line.number, "text": line.text, "link": line.link, "marks": line.marks, "notes": line.notes,
             "badge": line.badge} for line in s.lines]} for s in listing.sections],
        "lines": [{"number": line.number, "text": line.text, "link": line.link, "kind": line.kind, "sweep": line.sweep}
                  for line in listing.lines],
        "records": [] if found is None else [
            {"name": s.name, "bytes": None if s.grows else s.bytes, "what": s.what, "size": s.size,
             "words": byte_text(s.bytes) if s.bytes is not None and not s.grows else s.size,
             "link": listing.link(s.place, found.path)} for s in found.recorded],
        "tables": [] if found is None else list(_tables(listing, found))}


def _tables(listing: Listing, found: Findings) -> Iterable[dict[str, Any]]:
    """The findings as tables: a title, the columns, and rows with the statement that each leads to."""
    def row(place: FoundPlace | None, *cells: str) -> dict[str, Any]:
        return {"link": 0 if place is None else listing.link(place, found.path), "cells": cells}

    def places(found_places: Iterable[FoundPlace]) -> list[dict[str, Any]]:
        return [row(p, _where(p), p.text) for p in found_places]

    tables = [
        ("Recorded", ("name", "bytes", "what", "needed by"), [
            row(s.place, s.name, s.size, s.what, "; ".join(f"{_where(p)}: {p.text}" for p in s.needed_by))
            for s in found.recorded]),
        ("Variables", ("variable", "type", "verdict"), [
            row(None, v.variable, v.type, v.reason) for v in found.variables]),
        ("Computed again instead of recorded", ("variable", "how", "line", "statement"), [
            row(a.place, a.variable, a.how, _where(a.place), a.place.text) for a in found.again]),
        ("Left out of the forward sweep", ("line", "statement"), places(found.dropped)),
        ("Run in the reverse sweep only", ("line", "statement"), places(found.reversed_again)),
        ("Loops run forward and back per iteration", ("line", "statement"), places(found.loops)),
        ("Not differentiable", ("line", "statement", "what is done"), [
            row(k.place, _where(k.place), k.place.text, k.what) for k in found.kinks]),
        ("Run by the interpreter, which Numba's code calls", ("line", "statement"), places(found.interpreted))]
    return [{"title": title, "columns": columns, "rows": rows} for title, columns, rows in tables if rows]


def _where(place: FoundPlace) -> str:
    return f"{place.path}:{place.line}" if place.path else f"line {place.line}"
