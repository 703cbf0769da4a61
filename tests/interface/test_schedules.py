"""Schedules of the user's: what their actions come to, the gradients by them, and what is refused."""
from __future__ import annotations

import enum
from collections import namedtuple
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import s2sad
from s2sad import Snapshots
from s2sad.interface.schedules import schedule_of
from s2sad.program import NOTHING, Schedule
from tests.runtime.test_checkpoints import revolved

Storage = enum.Enum("Storage", {"RAM": 0, "DISK": 1, "WORK": -1, "NONE": None})
RAM, DISK, WORK, NONE = Storage.RAM, Storage.DISK, Storage.WORK, Storage.NONE
Forward = namedtuple("Forward", "n0 n1 write_ics write_adj_deps storage")
Reverse = namedtuple("Reverse", "n1 n0 clear_adj_deps")
Copy = namedtuple("Copy", "n from_storage to_storage")
Move = namedtuple("Move", "n from_storage to_storage")
EndForward = namedtuple("EndForward", "")
EndReverse = namedtuple("EndReverse", "")
Pause = namedtuple("Pause", "")


class Actions:
    """A schedule object that yields these actions, with what the package's have."""
    n = r = 0

    def __init__(self, steps: int | None, *actions: Any):
        self.max_n, self.actions = steps, actions

    def __iter__(self) -> Iterator[Any]:
        return iter(self.actions)

    def uses_storage_type(self, storage: Any) -> bool:
        return any(storage in a for a in self.actions)


SHORT = (Forward(0, 2, True, False, RAM), Forward(2, 3, False, True, WORK), EndForward(), Reverse(3, 2, True),
         Copy(0, RAM, WORK), Forward(0, 1, False, False, WORK), Forward(1, 2, False, True, WORK), Reverse(2, 1, True),
         Move(0, RAM, WORK), Forward(0, 1, False, True, WORK), Reverse(1, 0, True), EndReverse())
ON_DISK = tuple(a._replace(**{f: DISK for f, v in a._asdict().items() if v is RAM}) for a in SHORT)
WITH_TAPES = (Forward(0, 2, True, False, RAM), Forward(2, 3, False, True, RAM), Forward(3, 4, False, True, WORK),
              EndForward(), Reverse(4, 3, True), Move(2, RAM, WORK), Reverse(3, 2, True), Move(0, RAM, WORK),
              Forward(0, 1, False, True, RAM), Forward(1, 2, False, True, WORK), Reverse(2, 1, True),
              Move(0, RAM, WORK), Reverse(1, 0, True), EndReverse())
SEVERAL = (Forward(0, 2, True, False, RAM), Forward(2, 4, False, True, WORK), EndForward(), Reverse(4, 2, True),
           Move(0, RAM, WORK), Forward(0, 2, False, True, WORK), Reverse(2, 0, True), EndReverse())


def steps_of(u, c, n):
    energy, t = 0.0, 0.0
    for k in range(n):
        u[:] = u + c * np.sin(u + k * t)
        energy += np.sum(u)
        t = t + 0.1
    return energy


def test_a_table():
    assert schedule_of(Actions(3, *SHORT)) == Schedule("Actions", 3, 2, False, (
        (0, 0), (2, 1), NOTHING, (2, 1), NOTHING, (0, 0), NOTHING, (0, 0), NOTHING))
    assert schedule_of(Actions(4, *WITH_TAPES)).entries == (
        (0, 0), (2, 1), (3, 2), NOTHING, (3, 2), NOTHING, (2, 1), NOTHING, (0, 0), (0, 0), NOTHING, (0, 0), NOTHING)


@pytest.mark.parametrize("engine", ["numpy", "numba"])
@pytest.mark.parametrize(("steps", "actions"), [(3, SHORT), (3, ON_DISK), (4, WITH_TAPES), (4, SEVERAL)])
def test_gradients(steps, actions, engine, tmp_path):
    u = np.linspace(0.1, 0.6, 6)
    expected = s2sad.gradient(s2sad.differentiate(steps_of, engine=engine, checkpoint={"k": 2}), wrt="u")(u, 0.1, steps)
    chosen = Snapshots(Actions(steps, *actions), on_disk=str(tmp_path)) if actions is ON_DISK else Actions(
        steps, *actions)
    kept = s2sad.differentiate(steps_of, engine=engine, checkpoint={"k": chosen})
    for _ in range(2):
        np.testing.assert_array_equal(s2sad.gradient(kept, wrt="u")(u, 0.1, steps), expected)
    assert s2sad.check(kept, u, 0.1, steps)


def test_the_text():
    text = s2sad.differentiate(steps_of, engine="numpy", checkpoint={"k": Actions(3, *SHORT)}).adjoint_source(
        np.ones(3), 0.1, 3)
    assert "STEPS_OF_K_SCHEDULE = np.array(" in text and "u_snapshots[row] = u\n" in text
    space: dict[str, Any] = {}
    exec(text, space)
    u_bar = np.zeros(3)
    space["steps_of_adjoint"](np.ones(3), u_bar, 0.1, 3, 1.0)
    np.testing.assert_array_equal(u_bar, s2sad.gradient(s2sad.differentiate(steps_of, engine="numpy"), wrt="u")(
        np.ones(3), 0.1, 3))


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_another_number_of_steps(engine):
    u, kept = np.ones(3), s2sad.differentiate(steps_of, engine=engine, checkpoint={"k": Actions(3, *SHORT)})
    with pytest.raises(s2sad.S2sadError) as caught:
        kept.adjoint(u, np.zeros(3), 0.1, 4, 1.0)
    assert str(caught.value) == (
        "error[S501]: a loop runs another number of steps than its schedule\n  note: len(range(n)) is 4\n"
        "  help: make the schedule for the number that it runs")
    np.testing.assert_array_equal(u, 1.0)


def until(u, c, n):
    for k in range(n):
        u[:] = u + c * np.sin(u) * k
        if u[0] > 9.0:
            break
    return np.sum(u)


@pytest.mark.parametrize(("kernel", "chosen", "said"), [
    (steps_of, Actions(None, *SHORT), "the schedule Actions learns the number of steps while they run\n"
     "  help: give one that is made for their number"),
    (steps_of, Actions(3, *ON_DISK), "the schedule Actions of 'k' uses a disk, and there is no folder\n"
     '  help: give one: s2sad.Snapshots(schedule, on_disk="/scratch")'),
    (steps_of, Actions(3, *SHORT[:4], Pause()), "the schedule Actions has the action Pause(), which is not known"),
    (steps_of, Actions(3, *SHORT[:4], EndReverse()), "the schedule Actions reverses 1 of 3 steps"),
    (steps_of, Actions(3, *SHORT[:4], SHORT[5]), "the schedule Actions has the action Forward(n0=0, n1=1, "
     f"write_ics=False, write_adj_deps=False, storage={WORK!r}) where it cannot be followed"),
    (steps_of, Actions(3, *SHORT[:4], Copy(1, RAM, WORK)),
     f"the schedule Actions has the action Copy(n=1, from_storage={RAM!r}, to_storage={WORK!r}) where it cannot be "
     "followed"),
    (until, Actions(3, *SHORT), "how many steps this loop runs shows in the end, and a schedule is for a number that "
     "is known\n  help: give a number of snapshots"),
])
def test_what_is_refused(kernel, chosen, said):
    with pytest.raises(s2sad.S2sadError) as caught:
        s2sad.gradient(kernel, wrt="u", checkpoint={"k": chosen})(np.ones(3), 0.1, 3)
    lines = [line for line in str(caught.value).splitlines() if " | " not in line and not line.startswith(" -->")]
    assert "\n".join(lines).endswith(f"error[S408]: {said}")


# -- the package ------------------------------------------------------------------------------------------------------
def _made(name: str, *arguments: int) -> Callable[[], Any]:
    def made() -> Any:
        return getattr(pytest.importorskip("checkpoint_schedules"), name)(*arguments)
    return made


def _runs(schedule: Schedule) -> int:
    """The runs of steps, the forward sweep and those of steps' adjoints among them."""
    runs = schedule.steps
    ends = iter(range(schedule.steps - 1, -1, -1))
    first = schedule.entries.index(NOTHING) + 1
    for before, entry in zip(schedule.entries[first - 1:], schedule.entries[first:]):
        if before == NOTHING:
            runs += next(ends) - entry[0] + 1
    return runs


@pytest.mark.parametrize("made", [
    _made("Revolve", 12, 3), _made("MultistageCheckpointSchedule", 12, 2, 2), _made("HRevolve", 12, 2, 2),
    _made("DiskRevolve", 12, 2), _made("PeriodicDiskRevolve", 12, 2), _made("MixedCheckpointSchedule", 12, 3)])
@pytest.mark.filterwarnings("ignore")
def test_schedules_of_the_package(made, tmp_path):
    u = np.linspace(0.1, 0.6, 6)
    chosen = Snapshots(made(), on_disk=str(tmp_path))
    found = s2sad.gradient(s2sad.differentiate(steps_of, engine="numpy", checkpoint={"k": chosen}), wrt="u")(u, 0.1, 12)
    np.testing.assert_array_equal(found, s2sad.gradient(s2sad.differentiate(steps_of, engine="numpy"), wrt="u")(
        u, 0.1, 12))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("steps", [5, 20, 61])
def test_revolve_is_as_the_package_has_it(steps):
    for places in (1, 2, 5, 12):
        if places < steps:
            assert revolved(steps, places)[0] == _runs(schedule_of(_made("Revolve", steps, places)()))
