"""line_breaking: one logical line becomes lines that fit.

A logical line is a list of strings, `BREAK`s (a space where a new line may start) and `Pieces`. A group that
does not fit is broken: brackets after the opening one, everything between them indented by four and filled, the
closing one on a line of its own. Inner groups are broken last, so a line ends after the loosest operator.

>>> total = Pieces("optional", ["alpha *", BREAK, Pieces("brackets", ["a +", BREAK, "b"], "(", ")"), " +", BREAK, "c"])
>>> broken(["x = ", total], 0, 80)
['x = alpha * (a + b) + c']
>>> broken(["x = ", total], 0, 20)
['x = (', '    alpha *', '    (a + b) + c', ')']
"""
from __future__ import annotations

BREAK = None
INDENT = 4


class Pieces:
    """Pieces that belong together.

    kind "brackets" has brackets always, "optional" gets parentheses when it is broken, "plain" never has any;
    "text" is a string literal, `opening`, or where that is too long its parts, the items.
    """
    __slots__ = ("kind", "items", "opening", "closing", "width", "breakable", "bracketed")

    def __init__(self, kind: str, items: list, opening: str = "", closing: str = ""):
        self.kind, self.items, self.opening, self.closing = kind, items, opening, closing
        self.close()

    def close(self) -> None:
        """Measure the group, once its items are complete."""
        loose = [item for item in self.items if isinstance(item, Pieces)]
        own = len(self.opening) + len(self.closing)
        self.width = own if self.kind == "text" else own + flat_width(self.items)
        # breakable: a new line may start inside without any bracket; bracketed: it may inside a bracket
        self.breakable = self.kind != "brackets" and (
            any(item is BREAK for item in self.items) or any(item.breakable for item in loose))
        self.bracketed = self.kind == "brackets" or any(item.bracketed for item in loose)


def flat_width(items: list) -> int:
    return sum(1 if item is BREAK else len(item) if isinstance(item, str) else item.width for item in items)


def flat(items: list) -> str:
    """The pieces on one line."""
    return "".join(
        " " if item is BREAK else item if isinstance(item, str)
        else item.opening if item.kind == "text" else f"{item.opening}{flat(item.items)}{item.closing}"
        for item in items)


def _needs_parentheses(group: Pieces) -> bool:
    return group.kind == "optional" and (group.breakable or not group.bracketed)


def _lead(items: list) -> tuple[int, bool]:
    """The width up to the first place where a line may end, and whether there is one."""
    width = 0
    for item in items:
        if item is BREAK:
            return width, True
        if isinstance(item, str):
            width += len(item)
        elif item.kind == "brackets":
            return width + len(item.opening), True
        elif _needs_parentheses(item):
            return width + 1, True
        else:
            inner, ends = _lead(item.items)
            width += inner
            if ends:
                return width, True
    return width, False


def _chunks(items: list) -> list[list]:
    chunks: list[list] = [[]]
    for item in items:
        if item is BREAK:
            chunks.append([])
        else:
            chunks[-1].append(item)
    return chunks


class _Lines:
    """The lines so far and the current one."""

    def __init__(self, indent: int, width: int):
        self.done: list[str] = []
        self.current = " " * indent
        self.width = width

    def new_line(self, indent: int) -> None:
        self.done.append(self.current)
        self.current = " " * indent

    def fits(self, width: int) -> bool:
        return len(self.current) + width <= self.width

    def put(self, items: list, indent: int, tail: int) -> None:
        """Write pieces that do not fit flat; `tail` columns must remain for what follows them."""
        for position, item in enumerate(items):
            if isinstance(item, str):
                self.current += item
                continue
            rest, ends = _lead(items[position + 1:])
            rest += 0 if ends else tail
            if self.fits(item.width + rest):
                self.current += flat([item])
            else:
                self.put_broken(item, indent, rest)

    def put_broken(self, group: Pieces, indent: int, tail: int) -> None:
        parentheses = _needs_parentheses(group)
        if group.kind != "brackets" and not parentheses:
            self.fill(group.items, indent, tail)
            return
        self.current += "(" if parentheses else group.opening
        self.new_line(indent + INDENT)
        self.fill(group.items, indent + INDENT, 0)
        self.new_line(indent)
        self.current += ")" if parentheses else group.closing

    def fill(self, items: list, indent: int, tail: int) -> None:
        """Write pieces, as many on a line as fit."""
        chunks = _chunks(items)
        for position, chunk in enumerate(chunks):
            after = tail if position == len(chunks) - 1 else 0
            need = flat_width(chunk) + after
            space = " " if position else ""
            if self.fits(len(space) + need):
                self.current += space + flat(chunk)
                continue
            lead, ends = _lead(chunk)
            alone = indent + need <= self.width
            if position and (alone or not self.fits(1 + lead + (0 if ends else after))):
                self.new_line(indent)
                space = ""
            self.current += space
            if alone and self.fits(need):
                self.current += flat(chunk)
            else:
                self.put(chunk, indent, after)


def broken(items: list, indent: int, width: int) -> list[str]:
    """The lines of a logical line that starts at column `indent`."""
    if indent + flat_width(items) <= width:
        return [" " * indent + flat(items)]
    lines = _Lines(indent, width)
    lines.put(items, indent, 0)
    return [*lines.done, lines.current]
