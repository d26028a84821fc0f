"""Plugin of pytest: robots for tests of sketches, and what a failed test leaves.

Installed with the package, it gives tests the fixture `rumbo_sim`::

    def test_it_says_that_it_is_ready(rumbo_sim):
        sim = rumbo_sim(sketch="my_sketch", robot="uno")
        sim.serial.expect("ready", within_s=1)
"""

from __future__ import annotations

import pathlib
import re
import shutil
from collections.abc import Callable, Generator
from typing import Any

import pytest

from ._sim import Sim

#: The robots that a test has made.
_MADE: pytest.StashKey[list[Sim]] = pytest.StashKey()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds ``--rumbo-out``."""
    group = parser.getgroup("rumbo", "tests of sketches and robots")
    group.addoption(
        "--rumbo-out",
        default="rumbo-failures",
        metavar="FOLDER",
        help="where a failed test leaves what its robots did, a folder for each test (default: rumbo-failures)",
    )


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Writes what the robots of a failed test did, and says in its report where."""
    report = yield
    if call.when == "call" and report.failed and (said := _leave(item, item.stash.get(_MADE, []))):
        report.sections.append(("rumbo", said))
    return report


@pytest.fixture
def rumbo_sim(request: pytest.FixtureRequest) -> Callable[..., Sim]:
    """Makes robots as `rumbo.Sim` does, recorded from their start: a failed test leaves their logs and waveforms."""
    made: list[Sim] = []
    request.node.stash[_MADE] = made

    def make(*args: Any, **options: Any) -> Sim:
        sim = Sim(*args, **options)
        sim.record()
        made.append(sim)
        return sim

    return make


def _leave(item: pytest.Item, sims: list[Sim]) -> str:
    """Writes logs and waveforms of a failed test, and says where."""
    if not sims:
        return ""
    name = re.sub(r"[^\w.-]+", "_", item.nodeid).strip("_")
    folder = pathlib.Path(item.config.getoption("--rumbo-out"), name)
    shutil.rmtree(folder, ignore_errors=True)
    said = []
    try:
        folder.mkdir(parents=True)
        for number, sim in enumerate(sims):
            stem = folder / ("robot" if len(sims) == 1 else f"robot{number + 1}")
            log = stem.with_suffix(".mcap")
            sim.write_log(log)
            said.append(f"rumbo replay {log}")
            if sim.is_emulated:
                sim.write_vcd(stem.with_suffix(".vcd"))
                said.append(f"gtkwave {stem.with_suffix('.vcd')}")
    except (OSError, ValueError, RuntimeError) as error:
        said.append(f"what the robot did could not be written: {error}")
    return "\n".join(said)
