"""marked_loops: loops of which the text says that they keep snapshots are loops over the range alone.

    for k in s2sad.timesteps(range(n), snapshots=20):       for k in range(n):
    for t in enumerate(timesteps(times, snapshots=20)):     for t in enumerate(times):

`snapshots` may also be s2sad.Snapshots(20, on_disk="/scratch").

Where they stand, and how many they keep, is found in the source, by `snapshots_said`.
"""
from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace

from s2sad import tree
from s2sad.diagnostics import Diagnostic, S2sadError, Source, Span
from s2sad.program import Snapshots, SourcePlace
from s2sad.read.outside_values import AST, Captured, ModuleValue, dotted

_MARK = "timesteps"
_THROUGH = ("enumerate", "zip", "reversed")


def unmarked(captured: Captured) -> Captured:
    """The definition without such marks."""
    if _MARK not in captured.source.text or not any(map(_marked, tree.walk(captured.tree))):
        return captured
    ours = {name: _is_ours(name, captured) for n in tree.walk(captured.tree) if (call := _marked(n)) is not None
            and (name := tree.written(call.func))}
    made = tree.copy(captured.tree)
    for node in tree.walk(made):
        call = _marked(node)
        if call is not None and ours[tree.written(call.func)]:
            node.iter = tree.rebuild(node.iter, lambda n, call=call: call.args[0] if n is call else None)
    return replace(captured, tree=made)


def snapshots_said(source: Source, wanted: Collection[SourcePlace]) -> Iterator[tuple[SourcePlace, Snapshots]]:
    """Those of the places wanted at which a loop is marked in a source, and the snapshots that it keeps; raises
    S2sadError (S408)."""
    for part in (source, *source.others):
        if _MARK not in part.text or f"def {_MARK}(" in part.text:
            continue
        for node in tree.walk(tree.parse(part.text)):
            call = _marked(node)
            if call is not None and SourcePlace.of(part, node) in wanted:
                said = [*call.args[1:], *(k.value for k in call.keywords)]
                snapshots = _snapshots(said[0]) if len(said) == 1 else None
                if snapshots is None:
                    raise S2sadError(Diagnostic("S408", "how many snapshots a loop keeps is no positive number here",
                                                Span.of(part, call), help="write the number: "
                                                "timesteps(range(n), snapshots=20)"))
                yield SourcePlace.of(part, node), snapshots


def _snapshots(said: AST) -> Snapshots | None:
    """What a mark says; None where it cannot be read from the text."""
    if isinstance(said, tree.Constant):
        return Snapshots(said.value) if type(said.value) is int and said.value >= 1 else None
    if not isinstance(said, tree.Call) or tree.written(said.func).rpartition(".")[2] != Snapshots.__name__:
        return None
    given = dict(zip(("count", "on_disk"), said.args)) | {k.arg: k.value for k in said.keywords}
    values = {n: a.value for n, a in given.items() if isinstance(a, tree.Constant)}
    count, folder = values.get("count"), values.get("on_disk")
    if given.keys() - values.keys() or type(count) is not int or count < 1:
        return None
    return Snapshots(count, folder) if folder is None or isinstance(folder, str) else None


def _marked(node: AST) -> tree.Call | None:
    """The mark of a loop: what it goes through, or one of those that are counted or gone through at once."""
    waiting = [node.iter] if isinstance(node, tree.For) else []
    while waiting:
        call = waiting.pop()
        if isinstance(call, tree.Call) and call.args:
            called = tree.written(call.func).rpartition(".")[2]
            if called == _MARK:
                return call
            waiting += call.args if called in _THROUGH else []
    return None


def _is_ours(name: str, captured: Captured) -> bool:
    """Whether what is called is no function of the user's that has the same name."""
    root = name.partition(".")[0]
    if any(getattr(s, "name", "") == root for s in tree.walk_statements(captured.tree.body)):
        return False
    try:
        meaning = captured.scope.lookup(root)
    except S2sadError:
        return True
    path = meaning.name if isinstance(meaning, ModuleValue) else dotted(meaning) or ""
    return meaning is None or path.partition(".")[0] == "s2sad"
