"""What all tests share: this folder's parent on the path, quiet floating point, Hypothesis profiles, seeds, options."""
from __future__ import annotations

import gc
import os
import sys
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

ROOT = Path(__file__).resolve().parent.parent
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))

os.environ.setdefault("S2SAD_VERBOSE", "0")        # a slow machine says nothing that a test compares

_SLOW = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much]
settings.register_profile("ci", max_examples=300, deadline=None, derandomize=True, suppress_health_check=_SLOW)
settings.register_profile("quick", max_examples=40, deadline=None, derandomize=True, suppress_health_check=_SLOW)
PROFILE = "ci" if os.environ.get("CI") else "quick"
settings.load_profile(PROFILE)

collect_ignore_glob = ["golden/*"]  # texts to compare and run, no tests


def pytest_addoption(parser):
    parser.addoption("--update-golden", action="store_true", help="write the files of tests/golden anew")
    parser.addoption("--seed", type=int, default=0, help="other random inputs: of arrays, weights and programs")
    parser.addoption("--poison", action="store_true", help="nan in whatever is allocated and not yet written")
    parser.addoption("--compiled", action="store_true", help="let Numba compile what Python runs otherwise: hours")
    parser.addoption("--constructs", metavar="FOLDER", help="write what the texts for Numba do there, by case")


def pytest_collection_finish(session):
    from tests.harness.garbage import collect_rarely
    collect_rarely()


def pytest_configure(config):
    _seeded(config)
    config.addinivalue_line("markers", "emits(case): what the text for Numba does is compiled: harness/constructs.py")
    from s2sad.dispatch import artifacts
    artifacts.ENABLED = False   # every test derives what it asks for; tests/dispatch/test_artifacts.py says otherwise
    from s2sad.jacobians import batch_widths
    batch_widths.clock = lambda: 0.0    # widths go by numbers of directions; tests/jacobians/test_batch_widths.py
    if config.getoption("compiled"):
        from tests.harness.engines import compiling
        compiling.append(True)
    if config.getoption("poison"):
        from tests.harness.poison import poisoned
        mode = ExitStack()
        mode.enter_context(poisoned())
        config.add_cleanup(mode.close)
    if config.getoption("update_golden") and os.environ.get("CI"):
        raise pytest.UsageError("--update-golden is refused where CI is set: goldens are read before they are written")


def _seeded(config):
    """Other random inputs, where `--seed` or the variable of harness/seeds.py asks for them: before tests are read."""
    seed = config.getoption("seed") or int(os.environ.get("S2SAD_TEST_SEED", "0"))
    if seed:
        os.environ["S2SAD_TEST_SEED"] = config.option.hypothesis_seed = str(seed)
        settings.register_profile("seeded", settings.get_profile(PROFILE), derandomize=False, database=None)
        settings.load_profile("seeded")


@pytest.fixture(autouse=True)
def quiet_floating_point():
    """Edges are tested on purpose: infinities and nans are compared, not warned about."""
    with np.errstate(all="ignore"):
        yield


@pytest.fixture(autouse=True)
def constructs_are_compiled(request):
    """What a text for Numba does that Python runs here is compiled in a case of tests/corpus/compiled.txt."""
    mark = request.node.get_closest_marker("emits")
    if mark is None or request.config.getoption("compiled"):
        yield
        return
    from tests.harness import constructs
    from tests.harness.instrumentation import recorded
    with recorded() as found:
        yield
    (case,), folder = mark.args, request.config.getoption("constructs")
    if folder:
        constructs.write(folder, case, found)
    else:
        constructs.check(case, found)


@pytest.fixture
def own_garbage():
    """The test looks through what it makes itself, not through the millions of objects that others have left."""
    gc.freeze()
    yield
    gc.unfreeze()
