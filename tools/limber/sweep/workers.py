"""Runs of a sweep on Dask's workers: processes of this machine, or a cluster's."""

import logging
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import metadata
from typing import Any

from distributed import Client, Future, LocalCluster, as_completed

from limber.errors import RunError
from limber.paths import DISTRIBUTION
from limber.sweep.one_run import one_run

CONNECT_S = 10


@contextmanager
def client_of(address: str | None, processes: int | None) -> Iterator[Client]:
    """Of the scheduler at the address, or of one with so many workers here. Raises RunError."""
    logging.disable(logging.CRITICAL)  # of Dask: what fails is reported once, in words
    if address is None:
        with _here(processes) as cluster, Client(cluster) as client:
            yield client
        return
    try:
        client = Client(address, timeout=CONNECT_S)
    except (OSError, ValueError) as error:
        raise RunError(f"no scheduler answers at {address}; `dask scheduler` is one") from error
    with client:
        _require_limber(client, address)
        yield client


def rows(client: Client, tasks: Iterator[tuple[Any, ...]]) -> Iterator[list[dict[str, Any]]]:
    """As they come, in any order. `tasks`: arguments of one_run; twice as many as can run are
    underway at a time. Raises RunError for the first that a machine is to blame for.
    """
    waiting = as_completed([], with_results=True, raise_errors=False)
    runs: dict[Future, int] = {}
    try:
        while True:
            room = 2 * max(sum(client.nthreads().values()), 1) - len(runs)
            for _, task in zip(range(room), tasks, strict=False):  # in this order: none is lost
                future = client.submit(one_run, *task, pure=False)
                runs[future] = task[0]
                waiting.add(future)
            if not runs:
                return
            batch = waiting.next_batch()
            yield [result for future, result in batch if future.status == "finished"]
            for future, result in batch:
                run = runs.pop(future)
                if future.status == "cancelled":
                    raise ConnectionError
                if future.status != "finished":
                    raise RunError(f"run {run}: {result[1]}")
    except OSError as error:
        raise RunError(f"the scheduler at {client.scheduler.address} has gone") from error


def _here(processes: int | None) -> LocalCluster:
    """Its workers do not know Ctrl-C, which a terminal sends to them as well."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    how = {"threads_per_worker": 1, "dashboard_address": None, "silence_logs": logging.CRITICAL}
    try:
        return LocalCluster(n_workers=processes, **how)
    finally:
        signal.signal(signal.SIGINT, before)


def _require_limber(client: Client, address: str) -> None:
    """The same version on every worker; who joins later is refused by its first run."""
    try:
        client.wait_for_workers(1, timeout=CONNECT_S)
    except TimeoutError as error:
        raise RunError(f"{address} has no workers: `dask worker {address}` starts some") from error
    here = metadata.version(DISTRIBUTION)
    for worker, there in client.run(metadata.version, DISTRIBUTION, on_error="return").items():
        if there != here:
            there = there if isinstance(there, str) else "is missing"
            raise RunError(f"worker {worker}: limber {there}; this machine has {here}")
