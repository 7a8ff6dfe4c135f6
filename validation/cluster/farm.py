"""Tasks over Dask distributed: a cluster of this machine, or any whose scheduler has an address. Dask is imported where
it is needed, as it is there only once this package's commands have been used."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from tyndall.failure import Failure
from validation.cluster import task

Client = Any
Future = Any
CONNECT = 30
"""Seconds within which a scheduler answers."""


@contextmanager
def connected(scheduler: str | None, workers: int, retries: int) -> Iterator[Client]:
    """A client of the scheduler at an address, or of `workers` processes on this machine."""
    from distributed import Client

    if scheduler is None:
        with local(workers, retries) as cluster, Client(cluster) as client:
            yield client
        return
    try:
        client = Client(scheduler, timeout=CONNECT)
    except (OSError, ValueError) as error:
        raise Failure(f"{scheduler}: no scheduler answers: {error}", "start `dask scheduler`, and give the address that it prints") from None
    with client:
        yield client


@contextmanager
def local(workers: int, retries: int) -> Iterator[Any]:
    """Workers on this machine; a task may lose as many of them as it may fail."""
    import dask
    from distributed import LocalCluster

    with dask.config.set({"distributed.scheduler.allowed-failures": retries}):
        with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster:
            yield cluster


def slots(client: Client) -> int:
    """Tasks that can run at once, as far as is known now."""
    return max(1, sum(client.nthreads().values()))


def submit(client: Client, function: Callable[..., str], words: list[Any], label: str, retries: int) -> Future:
    """One task; Dask tries it again where it fails, and elsewhere where its worker is killed."""
    return client.submit(Sent(function), *words, key=f"{label}-{os.urandom(8).hex()}", retries=retries, pure=False)


@dataclass(frozen=True)
class Sent:
    """A function of `task`, which workers get by value: Dask would send its name, for a module that they need not have."""

    function: Callable[..., str]

    def __call__(self, *words: Any) -> str:
        return self.function(*words)

    def __reduce__(self) -> tuple[Callable[[bytes], Any], tuple[bytes]]:
        import cloudpickle

        cloudpickle.register_pickle_by_value(task)
        return cloudpickle.loads, (cloudpickle.dumps(self.function),)


def finished(client: Client, futures: list[Future], take: Callable[[list[str]], None]) -> None:
    """Hands over results as they come, several at once if they come faster than they are taken. Goes on when a task has
    failed for good, unless none has succeeded before: then none will."""
    from distributed import as_completed

    failures: list[str] = []
    came = 0
    for batch in as_completed(futures, raise_errors=False).batches():
        results = [future.result() for future in batch if future.status == "finished"]
        failures += [reason(future) for future in batch if future.status != "finished"]
        came += len(results)
        if results:
            take(results)
        elif came == 0:
            client.cancel(futures)
            break
    if failures:
        problem = f"{len(failures)} of {len(futures)} tasks failed, {came} succeeded; the first failure:\n{failures[0]}"
        raise Failure(problem, "mend that and run the same command again: what is done is kept")


def reason(future: Future) -> str:
    """Why a task did not succeed."""
    return str(future.exception()) if future.status == "error" else f"{future.key}: {future.status} by the scheduler"
