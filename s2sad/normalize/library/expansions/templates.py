"""The arguments of a call that is expanded, and the texts that expansions are made of."""
from __future__ import annotations

from s2sad.infer.inference import Typing
from s2sad.infer.signatures.laws import axes_of, is_true, items_of, whole_number
from s2sad.infer.signatures.options import is_none, text_of
from s2sad.infer.types import Type
from s2sad.tree import AST, List, Tuple, call


class CallArguments:
    """The arguments of one call, by parameter; the text of an expansion has the names of the parameters."""

    def __init__(self, arguments: dict[str, AST], typing: Typing):
        self.arguments, self.typing = dict(arguments), typing

    def type(self, parameter: str) -> Type:
        return self.typing.of(self.arguments[parameter])

    def rank(self, parameter: str) -> int:
        return self.type(parameter).rank

    def has(self, parameter: str) -> bool:
        """Whether an option is anything but None."""
        return not is_none(self.arguments[parameter])

    def flag(self, parameter: str) -> bool:
        return is_true(self.arguments[parameter])

    def number(self, parameter: str) -> int | None:
        return whole_number(self.arguments[parameter])

    def text(self, parameter: str) -> str:
        return text_of(self.arguments[parameter])

    def axes(self, rank: int, parameter: str = "axis") -> tuple[int, ...]:
        return axes_of(self.arguments[parameter], rank) or ()

    def axis(self, rank: int, parameter: str = "axis") -> int:
        return self.axes(rank, parameter)[0]

    def items(self, parameter: str) -> list[AST]:
        """The items of a tuple that is spelled out, or the one argument."""
        return items_of(self.arguments[parameter])

    def as_array(self, parameter: str) -> None:
        """Makes a list or a tuple that is spelled out an array."""
        if isinstance(node := self.arguments[parameter], (Tuple, List)):
            self.arguments[parameter] = call("numpy.array", node)

    def let(self, wanted: str, node: AST) -> str:
        """A parameter of its own for an expression."""
        found = next(f"{wanted}{k}" for k in range(1000) if f"{wanted}{k}" not in self.arguments)
        self.arguments[found] = node
        return found


def lines(*parts: str) -> str:
    return "\n".join(p for p in parts if p)


WEIGHTS = "there are not as many weights as elements"
NOT_AS_MANY = "there are not as many places, or values, along one axis as along another"
WINDOW = "a window that is longer than its axis, or has no elements"
SECTIONS = "np.split into sections that are not of one length: np.array_split makes such"


def guard(test: str, message: str) -> str:
    """The text of an assertion and its message."""
    return f"assert {test}, {message!r}"


def part(array: str, axis: int, taken: str) -> str:
    """The text of a subscript of one axis of an array."""
    return f"{array}[{':, ' * axis}{taken}]"


def size(array: str, axis: int) -> str:
    return f"{array}.shape[{axis}]"


def sizes(array: str, rank: int) -> list[str]:
    return [size(array, k) for k in range(rank)]


def shape(parts: list[str]) -> str:
    return parts[0] if len(parts) == 1 else f"({', '.join(parts)})"


def dtype_option(dtype: str, default: str = "float64") -> str:
    """The text of an option that says a dtype, "" for the default."""
    return "" if dtype == default else f", dtype=numpy.{dtype if dtype != 'bool' else 'bool_'}"


def made(function: str, parts: list[str], dtype: str) -> str:
    """The text of an allocation."""
    return f"numpy.{function}({shape(parts)}{dtype_option(dtype)})"


def empty(parts: list[str], dtype: str) -> str:
    return made("empty", parts, dtype)


def zeros(parts: list[str], dtype: str) -> str:
    return made("zeros", parts, dtype)
