"""Tables on the terminal, with rich where it is installed, else aligned columns; and in Markdown."""
from __future__ import annotations

import sys
from dataclasses import dataclass, field

from s2sad.report.timing import Times, seconds

__all__ = ["NOISE", "Table", "markdown", "noise", "seconds", "show", "shown", "verdict"]

NOISE = 0.3     # quartiles further apart than this, relative to the median: the time is not shown


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


def markdown(table: Table) -> str:
    """The table in Markdown: title, rows, remarks.

    >>> print(markdown(Table("Times", ("kernel", "s"), [("heat", "1.0")], ["One run."])))
    **Times**
    <BLANKLINE>
    | kernel | s |
    |---|---:|
    | heat | 1.0 |
    <BLANKLINE>
    One run.
    """
    rule = "|" + "|".join(["---", *["---:"] * (len(table.columns) - 1)]) + "|"
    rows = ["| " + " | ".join(text.replace("|", "\\|") for text in row) + " |" for row in (table.columns, *table.rows)]
    lines = [f"**{table.title}**", "", rows[0], rule, *rows[1:]]
    return "\n".join([*lines, "", *table.notes] if table.notes else lines)


def noise(times: Times) -> float:
    """The distance of the quartiles over the median."""
    return (times.upper - times.lower) / times.median


def shown(times: Times) -> str:
    """The median and half the distance of the quartiles, or that it does not repeat.

    >>> shown(Times(2e-3, 1.9e-3, 2.1e-3, 9)), shown(Times(2e-3, 1e-3, 3e-3, 9))
    ('2.00 ms ± 5 %', 'does not repeat')
    """
    return f"{seconds(times.median)} ± {50.0 * noise(times):.0f} %" if noise(times) <= NOISE else "does not repeat"


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
