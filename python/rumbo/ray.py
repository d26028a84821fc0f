"""Sweeps on Ray (https://ray.io), the extra ``ray`` of the package: ``rumbo.sweep(..., cluster="local")``.

No usage statistics leave a cluster that is started here.
"""

# The packages are looked for before they are imported.
# ruff: noqa: E402
from __future__ import annotations

import os
import socket
from collections.abc import Callable
from concurrent.futures import Future
from types import TracebackType
from typing import Any

# Before anything of Ray: its processes inherit it.
os.environ["RAY_USAGE_STATS_ENABLED"] = "0"

from ._extras import need

need("cluster=", "ray", "ray", (2, 60))

import ray
from ray._private import ray_constants

__all__ = ["Cluster"]

#: How often a piece is begun again whose worker died. One that kills every worker is not begun for ever.
RETRIES = 10
#: Memory for results on their way [bytes]: a piece has some kilobytes. Ray takes a third of the machine's by default.
STORE_BYTES = 100 << 20
#: The only address of a cluster on this machine, to which nobody else can connect.
LOCALHOST = "127.0.0.1"
#: Ray's switch for that, meant for systems on which it has no clusters: otherwise it takes the network's address for
#: any other, 127.0.0.1 too, and listens on all (2.60, `services.get_node_ip_address`).
ONE_MACHINE = "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER"
#: How long a running cluster has to answer [s].
PATIENCE_S = 10.0


def _call(work: Callable[[Any], Any], argument: Any) -> Any:
    return work(argument)


def _start(workers: int | None) -> None:
    """Starts a cluster to which no other machine can connect.

    Raises:
        RuntimeError: It would listen to the network; it is ended again.
    """
    before, was = os.environ.get(ONE_MACHINE), ray_constants.ENABLE_RAY_CLUSTER
    # For the cluster's processes, and for this one, which has read the variable already.
    os.environ[ONE_MACHINE], ray_constants.ENABLE_RAY_CLUSTER = "0", False
    try:
        ray.init(
            "local",
            num_cpus=workers,
            include_dashboard=False,
            log_to_driver=False,
            object_store_memory=STORE_BYTES,
        )
    finally:
        ray_constants.ENABLE_RAY_CLUSTER = was
        if before is None:
            del os.environ[ONE_MACHINE]
        else:
            os.environ[ONE_MACHINE] = before
    addresses = {node["NodeManagerAddress"] for node in ray.nodes()}
    if addresses != {LOCALHOST}:
        ray.shutdown()
        raise RuntimeError(f"Ray {ray.__version__} listens on {addresses}, not on {LOCALHOST} alone; use Ray 2.60")


def _connect(address: str) -> None:
    host, _, port = address.removeprefix("ray://").rpartition(":")
    try:
        if port.isdigit():
            # Ray itself would try for some minutes.
            socket.create_connection((host, int(port)), timeout=PATIENCE_S).close()
        ray.init(address, log_to_driver=False)
    except OSError as error:
        raise ConnectionError(
            f"cluster = {address!r}: no Ray cluster answers there ({error}); start one with `ray start --head`, "
            'or say "local"'
        ) from error


class Cluster:
    """Workers of Ray, for several sweeps: ``with rumbo.ray.Cluster("local") as here: rumbo.sweep(..., cluster=here)``.

    A worker that dies costs its piece a repetition. If this process is connected to Ray already, that connection is
    used, and kept.
    """

    #: How many pieces are worked on at once: the cluster's CPUs.
    workers: int

    def __init__(self, address: str = "local", *, workers: int | None = None) -> None:
        """Starts a cluster on this machine, or connects to one.

        Args:
            address: ``"local"``, or that of a running cluster as `ray.init` takes it, such as ``"auto"`` or
                ``"10.0.0.1:6379"``. Rumbo must be installed on its nodes.
            workers: Worker processes of a local cluster; one for each core by default.

        Raises:
            ModuleNotFoundError: Ray is not installed.
            ConnectionError: There is no cluster at the address.
            RuntimeError: A cluster on this machine would listen to the network.
            ValueError: A number of workers that is none, or one for a running cluster.
        """
        if workers is not None and (workers < 1 or address != "local"):
            raise ValueError(f'{workers} workers: must be 1 or more, and only for "local": a cluster has its own')
        self._is_own = not ray.is_initialized()
        if self._is_own and address == "local":
            _start(workers)
        elif self._is_own:
            _connect(address)
        self.workers = max(1, int(ray.cluster_resources().get("CPU", 1)))
        self._task = ray.remote(num_cpus=1, max_retries=RETRIES)(_call)
        # What is called, here and in the cluster.
        self._work: tuple[Callable[[Any], Any], Any] | None = None

    def submit(self, work: Callable[[Any], Any], argument: Any) -> Future[Any]:
        """Has a worker call ``work(argument)``; ``work`` is sent once while it is the same."""
        if self._work is None or self._work[0] is not work:
            self._work = (work, ray.put(work))
        future: Future[Any] = self._task.remote(self._work[1], argument).future()
        return future

    def cancel(self, future: Future[Any]) -> None:
        """Ends a call as Ctrl-C would."""
        ray.cancel(future.object_ref)  # type: ignore[attr-defined]

    def close(self) -> None:
        """Ends a cluster that was started here, or leaves one that was connected to."""
        self._work = None
        if self._is_own:
            ray.shutdown()

    def __enter__(self) -> Cluster:
        """Itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """As `close`."""
        self.close()
