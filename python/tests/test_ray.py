"""Sweeps on Ray, with clusters of two workers on this machine: `cargo xtask campaign --only ray`."""

from __future__ import annotations

import collections
import csv
import http.server
import os
import pathlib
import pickle
import secrets
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from typing import Any

import pytest

import rumbo

pytest.importorskip("ray", reason="the extra `ray` is not installed")

# In place of a file in the home folder.
os.environ.setdefault("RAY_AUTH_TOKEN", secrets.token_hex(32))

import ray.cluster_utils

import rumbo.ray

AXES = {"front_kp": "2:10:5", "battery.open_circuit_v": [7.0, 8.0]}
RUNS = 60
TOTAL = 10 * RUNS


def written(sweep: rumbo.Sweep, path: pathlib.Path) -> bytes:
    """The table as a file."""
    columns = sweep.to_dict()
    with open(path, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(columns)
        table.writerows(zip(*(column.tolist() for column in columns.values())))
    return path.read_bytes()


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """That of the sweep on threads of this process."""
    content = written(
        rumbo.sweep("mode1", AXES, seeds=range(1, RUNS + 1)), tmp_path_factory.mktemp("table") / "here.csv"
    )
    assert content.count(b"\n") == TOTAL + 1
    return content


def listening() -> set[str]:
    """Addresses and ports, in hexadecimal, on which other machines could connect to this one."""
    found = set()
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        for line in pathlib.Path(table).read_text().splitlines()[1:]:
            local, state = line.split()[1], line.split()[3]
            # 127.0.0.1, also as an address of IPv6, and ::1.
            if state == "0A" and not local.split(":")[0].endswith(("0100007F", "00000000000000000000000001000000")):
                found.add(local)
    return found


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the sockets of Linux")
def test_no_other_machine_can_connect_to_a_cluster_on_this_one() -> None:
    before = listening()
    with rumbo.ray.Cluster("local", workers=2) as here:
        assert here.submit(abs, -1).result() == 1
        assert listening() <= before


class Noted:
    """A cluster whose pieces take a while, and note their process and their first job when they begin and end."""

    def __init__(self, inner: rumbo.ray.Cluster, notes: pathlib.Path) -> None:
        self.inner, self.notes, self.workers = inner, notes, inner.workers
        self.noting: Callable[[Any], Any] | None = None

    def submit(self, work: Callable[[Any], Any], argument: Any) -> Future[Any]:
        path = str(self.notes)

        def noting(jobs: Any) -> Any:
            def note(what: str) -> None:
                with open(path, "a") as file:
                    file.write(f"{what} {os.getpid()} {jobs[0]}\n")

            note("begin")
            time.sleep(0.3)
            done = work(jobs)
            note("end")
            return done

        self.noting = self.noting or noting
        return self.inner.submit(self.noting, argument)

    def cancel(self, future: Future[Any]) -> None:
        self.inner.cancel(future)

    def lines(self, what: str) -> list[tuple[int, str]]:
        words = (line.split(maxsplit=2) for line in self.notes.read_text().splitlines())
        return [(int(process), job) for begin_or_end, process, job in words if begin_or_end == what]

    def working(self) -> dict[int, str]:
        """The processes in the middle of a piece, with its first job."""
        ended = self.lines("end")
        return {process: job for process, job in self.lines("begin") if (process, job) not in ended}


def test_a_worker_killed_in_the_middle_costs_its_piece_a_repetition(tmp_path: pathlib.Path, table: bytes) -> None:
    killed: dict[int, str] = {}

    def kill_once(done: int, _: int) -> None:
        if done <= TOTAL / 3 or killed:
            return
        for process, job in noted.working().items():
            # Held, so that its piece does not end before it dies.
            os.kill(process, signal.SIGSTOP)
            time.sleep(0.05)
            if noted.working().get(process) == job:
                killed[process] = job
                os.kill(process, signal.SIGKILL)
                return
            os.kill(process, signal.SIGCONT)

    with rumbo.ray.Cluster("local", workers=2) as cluster:
        assert cluster.workers == 2
        # This process is connected already: that is used, and kept.
        with rumbo.ray.Cluster("local") as again:
            assert again.workers == 2
        noted = Noted(cluster, tmp_path / "notes")
        sweep = rumbo.sweep("mode1", AXES, seeds=range(1, RUNS + 1), cluster=noted, progress=kill_once)
    assert not ray.is_initialized()
    assert written(sweep, tmp_path / "there.csv") == table
    begun = collections.Counter(job for _, job in noted.lines("begin"))
    (lost,) = killed.values()
    assert begun.pop(lost) == 2 and set(begun.values()) == {1}
    # Each result is of one end of a piece, and the one that was killed has none.
    assert len(noted.lines("end")) == len(begun) + 1


def test_a_node_lost_in_the_middle_of_a_running_cluster_loses_nothing(tmp_path: pathlib.Path, table: bytes) -> None:
    running = ray.cluster_utils.Cluster(
        initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False}
    )
    try:
        nodes = [running.add_node(num_cpus=1) for _ in range(2)]

        def kill_once(done: int, _: int) -> None:
            if done > TOTAL / 3 and len(nodes) == 2:
                running.remove_node(nodes.pop(), allow_graceful=False)

        with rumbo.ray.Cluster(running.address) as cluster:
            assert cluster.workers == 2
            noted = Noted(cluster, tmp_path / "notes")
            sweep = rumbo.sweep("mode1", AXES, seeds=range(1, RUNS + 1), cluster=noted, progress=kill_once)
        assert len(nodes) == 1
    finally:
        ray.shutdown()
        running.shutdown()
    assert written(sweep, tmp_path / "there.csv") == table


SCRIPT = """
import pickle, sys
import rumbo

def count(done, of):
    if done == 20:
        print("go", flush=True)

try:
    rumbo.sweep("mode1", {axes!r}, seeds=range(20_000), cluster="local", threads=2, progress=count)
except rumbo.Interrupted as stopped:
    pickle.dump(stopped.done, open(sys.argv[1], "wb"))
    print("kept", len(stopped.done), flush=True)
"""


def processes_of(session: int) -> list[str]:
    listed = subprocess.run(["ps", "-e", "-o", "sess=,pid=,args="], capture_output=True, text=True, check=True)
    return [line for line in listed.stdout.splitlines() if int(line.split()[0]) == session]


def test_ctrl_c_cancels_what_runs_and_keeps_what_is_done(tmp_path: pathlib.Path) -> None:
    command = [sys.executable, "-c", SCRIPT.format(axes=AXES), str(tmp_path / "done")]
    # Its own session, as in a terminal: all of its processes get the signal.
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True) as script:
        assert script.stdout is not None
        assert script.stdout.readline() == "go\n"
        assert len(processes_of(script.pid)) > 3
        os.killpg(script.pid, signal.SIGINT)
        kept = script.stdout.readline().split()
    assert script.returncode == 0
    with open(tmp_path / "done", "rb") as file:
        done = pickle.load(file)
    assert kept == ["kept", str(len(done))] and 20 <= len(done) < 200_000
    for row in (0, len(done) - 1):
        values = {name: column[done.point[row]] for name, column in done.points.items()}
        run = rumbo.run("mode1", seeds=int(done.seeds[row]), parameters=values)[0]
        assert {name: column[row] for name, column in done.metrics.items()} == pytest.approx(
            run.metrics, rel=0, abs=0, nan_ok=True
        )
    # Ray's own processes end a moment after the one that began them.
    for _ in range(100):
        if not processes_of(script.pid):
            return
        time.sleep(0.1)
    raise AssertionError(processes_of(script.pid))


class Reports(http.server.BaseHTTPRequestHandler):
    """Where Ray would report to."""

    bodies: list[bytes] = []  # noqa: RUF012

    def do_POST(self) -> None:
        self.bodies.append(self.rfile.read(int(self.headers["Content-Length"])))
        self.send_response(200)
        self.end_headers()

    def log_message(self, *_: Any) -> None:
        pass


@pytest.fixture
def reports() -> Iterator[tuple[list[bytes], dict[str, str]]]:
    """What was reported, and the environment in which Ray would."""
    Reports.bodies.clear()
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Reports)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield (
        Reports.bodies,
        {
            **os.environ,
            "RAY_USAGE_STATS_ENABLED": "1",
            "RAY_USAGE_STATS_REPORT_INTERVAL_S": "1",
            "RAY_USAGE_STATS_REPORT_URL": f"http://127.0.0.1:{server.server_port}",
        },
    )
    server.shutdown()
    server.server_close()


CLUSTER = """
import ray.cluster_utils, time
cluster = ray.cluster_utils.Cluster(initialize_head=True, head_node_args=dict(num_cpus=1, include_dashboard=False))
time.sleep(8)
cluster.shutdown()
"""

SWEEP = """
import time
import rumbo.ray
with rumbo.ray.Cluster("local", workers=1) as cluster:
    rumbo.sweep("mode1", {"front_kp": [5.0]}, cluster=cluster)
    time.sleep(8)
"""


def test_no_usage_statistics_leave_the_cluster(reports: tuple[list[bytes], dict[str, str]]) -> None:
    bodies, environment = reports
    subprocess.run([sys.executable, "-c", SWEEP], env=environment, check=True, timeout=120)
    assert not bodies
    # Without Rumbo this environment makes Ray report: the test can fail.
    subprocess.run([sys.executable, "-c", CLUSTER], env=environment, check=True, timeout=120)
    assert bodies


def test_an_address_without_a_cluster_says_so() -> None:
    for address in ("127.0.0.1:9", "ray://127.0.0.1:9", "nowhere.invalid:6379", "auto"):
        with pytest.raises(ConnectionError, match="cluster = .*ray start --head"):
            rumbo.sweep("mode1", AXES, cluster=address)
    with pytest.raises(ValueError, match="a cluster has its own"):
        rumbo.sweep("mode1", AXES, cluster="127.0.0.1:9", threads=2)
