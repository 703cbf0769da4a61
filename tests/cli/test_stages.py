"""`s2sad stages`: the text after every stage."""
from __future__ import annotations

import numpy as np
import pytest

from s2sad.report.stages import KERNEL_STAGES, STAGES, stages
from s2sad import read
from s2sad.infer.types import of_value
from s2sad.program import Request
from benchmarks.kernels.cases import LOOPS
from tests.cli.files import BRUSSELATOR


@pytest.mark.parametrize("engine", ["numpy", "numba"])
def test_every_stage_is_python_that_can_be_run(engine):
    program = read.load_file(*BRUSSELATOR.split(":"))
    case = next(c for c in LOOPS if c.name == "brusselator")
    types = tuple(map(of_value, case.arguments("small")))
    texts = stages(program, Request("adjoint", types, ("u", "p"), ("du",), engine, "fast"))
    assert list(texts) == list(STAGES)
    for stage, text in {text: (stage, text) for stage, text in texts.items()}.values():
        space = {}
        exec(compile(text, stage, "exec"), space)
        if stage in KERNEL_STAGES:
            given, expected = case.arguments("small"), case.arguments("small")
            case.function(*expected)
            space["brusselator"](*given)
            assert np.allclose(given[0], expected[0], rtol=1e-14)
        else:
            du, u, p, t = case.arguments("small")
            u_bar, p_bar = np.zeros_like(u), np.zeros_like(p)
            space["brusselator_adjoint"](du, np.ones_like(du), u, u_bar, p, p_bar, t)
            assert abs(p_bar[1] - 49.0) < 1e-9


def test_a_stage_by_its_name(ran):
    status, text, err = ran("stages", BRUSSELATOR, "--after", "single_exit", "--wrt", "u,p")
    assert status == 0, err
    assert text.splitlines()[0] == '"""brusselator after single_exit."""'


def test_all_stages_and_rooms(ran):
    text = ran("stages", BRUSSELATOR)[1]
    assert [line.split()[3] for line in text.splitlines() if line.startswith("# ---- after")] == list(STAGES)
    room, stage = (ran("stages", BRUSSELATOR, "--after", after)[1] for after in ("normalize", "check_known"))
    assert room == stage
