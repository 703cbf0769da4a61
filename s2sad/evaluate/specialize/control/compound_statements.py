"""with, match.
"""
from __future__ import annotations

from typing import Any

from s2sad import tree
from s2sad.evaluate.specialize.control.known_exceptions import ending, return_at_the_end
from s2sad.evaluate.specialize.evaluation_state import Frame
from s2sad.evaluate.specialize.evaluator import Evaluator, statement
from s2sad.evaluate.specialize.heap import Temporary
from s2sad.evaluate.specialize.values import (
    NONE, ClassValue, Data, Iteration, LibraryValue, Reference, ResidualObject, TupleValue, Value, constant,
)
from s2sad.tree import AST


@statement("With")
def with_statement(ev: Evaluator, s: Any, f: Frame) -> None:
    item, *others = s.items
    body = [tree.replica(s, lambda value, name: others if name == "items" else value)] if others else s.body
    manager = ev.value(item.context_expr, f)
    if isinstance(manager, Iteration) and manager.kind == "yields":
        _with_generator(ev, s, manager, body, f)
    elif isinstance(manager, Reference) and ev.heap[manager].kind == "record":
        entered = ev.call(ev.attribute_of(manager, "__enter__", s, f), [], {}, s, f)
        leave = ev.attribute_of(manager, "__exit__", s, f)
        if item.optional_vars is not None:
            ev.store(item.optional_vars, entered, f)
        handlers, ev.handlers = ev.handlers, []     # an exception would be given to __exit__
        try:
            ending(ev, body, lambda: ev.call(leave, [NONE, NONE, NONE], {}, s, f), f)
        finally:
            ev.handlers = handlers
    elif isinstance(manager, Data) and isinstance(manager.node, tree.Call) and item.optional_vars is None:
        ev.statements(body, f)
    else:
        raise ev.refusal(s, "this context manager is not supported in a kernel")


def _with_generator(ev: Evaluator, s: Any, manager: Iteration, body: list[AST], f: Frame) -> None:
    """A manager that is made of a generator: the body is evaluated where it yields."""
    end = return_at_the_end(ev, body)
    slot, entered = Temporary("result", id(s)), []

    def within(value: Value) -> None:
        if entered:
            raise ev.refusal(s, "a context manager yields more than once")
        entered.append(True)
        if s.items[0].optional_vars is not None:
            ev.store(s.items[0].optional_vars, value, f)
        ev.statements(body[:-1] if end is not None else body, f)
        if end is not None:
            found = NONE if end.value is None else ev.atoms(ev.value(end.value, f), "result", end)
            ev.heap.put(f.reference, slot, found)
    ev.used(manager, s)
    ev.each_item(manager, s, f, within)
    if end is not None:
        ev.leave_function(end, ev.heap[f.reference].items[slot], f)


@statement("Match")
def match(ev: Evaluator, s: Any, f: Frame) -> None:
    _try_cases(ev, s, ev.atoms(ev.value(s.subject, f), "subject", s), 0, f)


def _try_cases(ev: Evaluator, s: Any, subject: Value, k: int, f: Frame) -> None:
    """The first case from a place on that applies; where only the run knows whether one does, the others are its
    `else`."""
    if k == len(s.cases):
        return
    case = s.cases[k]

    def otherwise() -> None:
        _try_cases(ev, s, subject, k + 1, f)

    def guarded() -> None:
        passes = True if case.guard is None else ev.test_of(case.guard, f)
        if isinstance(passes, Data):
            ev.branch(passes, (lambda: ev.statements(case.body, f), otherwise), case.guard)
        elif passes:
            ev.statements(case.body, f)
        else:
            otherwise()
    applies = _test_of_pattern(ev, case.pattern, subject, f)
    if isinstance(applies, Data):
        ev.branch(applies, (guarded, otherwise), case.pattern)
    elif applies:
        guarded()
    else:
        otherwise()


def _test_of_pattern(ev: Evaluator, pattern: Any, subject: Value, f: Frame) -> bool | Data:
    """Whether a pattern applies; of a number that only the run knows, the comparison with a value, or with several."""
    if type(pattern).__name__ == "MatchValue" and isinstance(subject, Data):
        return ev.truth(ev.compared(tree.Eq(), subject, ev.value(pattern.value, f), pattern, f), pattern, f)
    if type(pattern).__name__ != "MatchOr":
        return _matches(ev, pattern, subject, f)
    tests = [_test_of_pattern(ev, p, subject, f) for p in pattern.patterns]
    unknown = [ev.spelled(t, pattern) for t in tests if isinstance(t, Data)]
    if True in tests or not unknown:
        return True in tests
    return Data(tree.at(unknown[0] if len(unknown) == 1 else tree.BoolOp(tree.Or(), unknown), pattern))


def _matches(ev: Evaluator, pattern: Any, subject: Value, f: Frame) -> bool:
    kind = type(pattern).__name__
    if kind in ("MatchSequence", "MatchMapping") and isinstance(subject, ResidualObject):
        raise ev.unknown(pattern, "what is matched must be known before the run", help="compare its items")
    if kind in ("MatchValue", "MatchSingleton"):
        value = ev.value(pattern.value, f) if kind == "MatchValue" else constant(pattern.value)
        found = ev.compared(tree.Eq() if kind == "MatchValue" else tree.Is(), subject, value, pattern, f)
        return bool(ev.known(found, pattern, "what is matched"))
    if kind == "MatchAs":
        if pattern.pattern is not None and not _matches(ev, pattern.pattern, subject, f):
            return False
        if pattern.name:
            ev.bind(f, pattern.name, subject, pattern)
        return True
    if kind == "MatchOr":
        return any(_matches(ev, p, subject, f) for p in pattern.patterns)
    if kind == "MatchSequence":
        return _matches_sequence(ev, pattern, subject, f)
    if kind == "MatchMapping":
        return _matches_mapping(ev, pattern, subject, f)
    if kind == "MatchClass":
        return _matches_class(ev, pattern, subject, f)
    raise ev.refusal(pattern, "this pattern is not supported in a kernel")


def _matches_sequence(ev: Evaluator, pattern: Any, subject: Value, f: Frame) -> bool:
    """Whether a tuple or a list has as many items, and these match; arrays are no sequences for Python."""
    if isinstance(subject, Data) and not isinstance(subject.known, str):
        if subject.is_list or isinstance(subject.known, tuple) or subject.shape is None and not subject.is_known:
            raise ev.unknown(pattern, "what is matched must be known before the run", subject)
        return False
    if not (isinstance(subject, TupleValue) or isinstance(subject, Reference) and ev.heap[subject].kind == "list"):
        return False
    items, patterns = list(ev.sequence_items(subject)), pattern.patterns
    star = next((k for k, p in enumerate(patterns) if type(p).__name__ == "MatchStar"), None)
    if star is None:
        return len(patterns) == len(items) and all(_matches(ev, p, v, f) for p, v in zip(patterns, items))
    behind = len(patterns) - star - 1
    if len(items) < star + behind:
        return False
    rest = items[star:len(items) - behind]
    if not all(_matches(ev, p, v, f) for p, v in zip(
            [*patterns[:star], *patterns[star + 1:]], [*items[:star], *items[len(items) - behind:]])):
        return False
    if patterns[star].name:
        ev.bind(f, patterns[star].name, ev.list_of(rest, pattern), pattern)
    return True


def _matches_mapping(ev: Evaluator, pattern: Any, subject: Value, f: Frame) -> bool:
    """Whether a dict has the keys, and what lies there matches."""
    if isinstance(subject, Data) and subject.shape is None and not subject.is_known:
        raise ev.unknown(pattern, "what is matched must be known before the run", subject)
    if not (isinstance(subject, Reference) and ev.heap[subject].kind == "dict"):
        return False
    if pattern.rest is not None:
        raise ev.refusal(pattern, "'**' in a pattern is not supported in a kernel", help="name the keys")
    items = ev.heap[subject].items
    keys = [ev.key_of(ev.value(k, f), pattern) for k in pattern.keys]
    return all(k in items for k in keys) and all(
        _matches(ev, p, items[k], f) for k, p in zip(keys, pattern.patterns))


_SELF = tuple(f"builtins.{n}" for n in ("bool", "float", "int", "str", "list", "tuple", "dict", "set", "frozenset"))


def _matches_class(ev: Evaluator, pattern: Any, subject: Value, f: Frame) -> bool:
    """Whether an object is of a class, and its attributes match; those by position as `__match_args__` names them."""
    made = ev.value(pattern.cls, f)
    found = ev.is_instance(subject, made, pattern)
    if found is None:
        raise ev.unknown(pattern, "the type of what is matched must be known before the run", subject)
    if not found:
        return False
    if isinstance(made, LibraryValue) and made.path in _SELF:
        return not pattern.kwd_patterns and all(_matches(ev, p, subject, f) for p in pattern.patterns)
    names = [*_match_args(ev, made, pattern, f), *pattern.kwd_attrs]
    return all(ev.has_attribute(subject, n, pattern, f) and _matches(ev, p, ev.attribute_of(subject, n, pattern, f), f)
               for n, p in zip(names, [*pattern.patterns, *pattern.kwd_patterns]))


def _match_args(ev: Evaluator, made: Value, pattern: Any, f: Frame) -> list[str]:
    """The attributes that the patterns by position are of."""
    count = len(pattern.patterns)
    if not count:
        return []
    layout = ev.layout_of(made) if isinstance(made, ClassValue) else None
    own = isinstance(made, ClassValue) and ev.class_item(made, "__match_args__", pattern, f)
    names = [ev.known(i, pattern, "__match_args__") for i in ev.items_of(own[1], pattern, f)] if own else [
        d.name for d in layout.fields if d.is_given and not d.by_name] if layout is not None else []
    if len(names) < count:
        raise ev.refusal(pattern, "the class of this pattern has fewer attributes by position",
                         help="name the attributes: Class(name=pattern)")
    return names[:count]
