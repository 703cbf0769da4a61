"""What the functions of a module that is being made read and write."""
from __future__ import annotations

from dataclasses import dataclass, field

from s2sad.differentiate.split_adjoints import POP, PUSH
from s2sad.infer.inference import Typing
from s2sad.liveness import Accesses, Liveness, base_name, targets
from s2sad.tree import Assert, Assign, AugAssign, Call, FunctionDef, Raise, Subscript, call_name, names, user_call, walk


@dataclass(frozen=True)
class Effect:
    """Of a function that was made: the positions of arrays that it reads and writes, and whether it may be dropped."""
    reads: frozenset[int]
    writes: frozenset[int]
    pure: bool
    arrays: frozenset[int] = frozenset()


@dataclass
class Effects:
    """The effects of the functions of a module that is being made."""
    table: dict[str, Effect] = field(default_factory=dict)

    def of(self, called: Call) -> Effect | None:
        return self.table.get(user_call(called) or "")

    def writes(self, called: Call) -> list[str]:
        effect = self.of(called)
        if call_name(called) in (PUSH, POP):
            return [base_name(called.args[0])]
        if effect is None:
            return []
        return [b for k, a in enumerate(called.args) if k in effect.writes and (b := base_name(a))]

    def unread(self, called: Call) -> set[str]:
        effect = self.of(called)
        if effect is None:
            return set()
        bases = [(k, base_name(a)) for k, a in enumerate(called.args) if k in effect.arrays]
        read = {b for k, b in bases if k in effect.reads}
        for position, argument in enumerate(called.args):
            if position not in effect.arrays:
                read |= set(names(argument))
            elif isinstance(argument, Subscript):
                read |= set(names(argument.slice))
        return {b for _, b in bases if b} - read

    def pure(self, called: Call) -> bool:
        effect = self.of(called)
        return (call_name(called) or "") != "builtins.print" and (effect is None or effect.pure)

    def written(self, function: FunctionDef) -> set[str]:
        """The names of arrays that a function stores into, itself or by what it calls."""
        written: set[str] = set()
        for node in walk(function.body):
            if isinstance(node, (Assign, AugAssign)):
                written |= {base_name(t) for t in targets(node) if isinstance(t, Subscript)}
                written |= {base_name(node.target)} if isinstance(node, AugAssign) else set()
            elif isinstance(node, Call):
                written |= set(self.writes(node))
        return written

    def add(self, function: FunctionDef, typing: Typing) -> None:
        """Registers a finished function."""
        parameters = [p.id for p in function.args.args]
        live = Liveness(function, set(), Accesses(unread=self.unread), strong=False)
        reads = {k for k, p in enumerate(parameters) if p in live.start}
        written = self.written(function)
        pure = all(self.pure(n) if isinstance(n, Call) else not isinstance(n, (Assert, Raise))
                   for n in walk(function.body))
        arrays = frozenset(k for k, p in enumerate(parameters) if typing.table[p].is_array)
        self.table[function.name] = Effect(
            frozenset(reads), frozenset(k for k in arrays if parameters[k] in written), pure, arrays)
