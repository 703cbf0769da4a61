"""Tables on the terminal: with rich where it is installed, else aligned columns."""
from __future__ import annotations

import sys
from dataclasses import dataclass, field

from s2sad.report.timing import seconds

__all__ = ["Table", "seconds", "show", "verdict"]


@dataclass
class Table:
    """A title, the columns' names, rows of texts, and remarks below."""
    title: str
    columns: tuple[str, ...]
    rows: list[tuple[str, ...]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def show(table: Table) -> None:
    """Prints a table; a column is right-aligned unless it is the first."""
    if sys.stdout.isatty() and _rich(table):
        return
    widths = [max(len(row[k]) for row in [table.columns, *table.rows]) for k in range(len(table.columns))]
    rule = "-" * (sum(widths) + 2 * len(widths) - 2)
    print(table.title, rule, _line(table.columns, widths), rule, sep="\n")
    for row in table.rows:
        print(_line(row, widths))
    print(rule, *(f"  {note}" for note in table.notes), "", sep="\n")


def verdict(value: float, target: float, least: bool = False) -> str:
    """Whether a figure is at most, or with `least` at least, its target.

    >>> verdict(2.0, 2.5), verdict(3.0, 2.5), verdict(17.0, 8.0, least=True)
    ('met', 'missed', 'met')
    """
    return "met" if (value >= target if least else value <= target) else "missed"


def _line(row: tuple[str, ...], widths: list[int]) -> str:
    return "  ".join(text.rjust(w) if k else text.ljust(w) for k, (text, w) in enumerate(zip(row, widths))).rstrip()


def _rich(table: Table) -> bool:
    try:
        from rich.console import Console
        from rich.table import Table as RichTable
    except ImportError:
        return False
    made = RichTable(title=table.title, title_justify="left", caption="\n".join(table.notes), caption_justify="left")
    for k, column in enumerate(table.columns):
        made.add_column(column, justify="right" if k else "left")
    for row in table.rows:
        made.add_row(*row, style="red" if "missed" in row else None)
    Console().print(made)
    return True
