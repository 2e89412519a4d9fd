"""Tasks on the workers of dask.distributed."""

import hashlib
import math
import operator
import pkgutil
import time
import warnings
from collections.abc import Hashable, Iterator
from typing import Any

import dask
from distributed import Client, Future, KilledWorker, as_completed, default_client
from distributed.protocol.pickle import dumps

from . import _raio


class Killed(Exception):
    """Several workers ended while they did this task."""


class Lost(Exception):
    """The result is lost: do it again."""


class Tasks:
    """Items of work that are being done. Use it in a `with` statement, whose end withdraws them.

    Raises:
        ValueError: there is no client.
    """

    def __init__(self, client: Client | None, name: str):
        if client is None:
            try:
                client = default_client()
            except ValueError:
                raise ValueError("client: expected a dask.distributed.Client; `Client()` starts workers on this "
                                 "machine") from None
        if not isinstance(client, Client) or client.asynchronous:
            raise TypeError(f"client: expected a dask.distributed.Client that is not asynchronous, found {client!r}; "
                            "of a cluster, `Client(cluster)` is one")
        self.client = client
        self._name, self._count = name, 0
        self._pending: dict[Future, Any] = {}
        self._ended = as_completed(with_results=True, raise_errors=False)
        self._finished: dict[Future, float] = {}  # since when; their results are on the way
        self._looked = 0.0
        self._cores, self._asked = 0, 0.0
        self._patient_until = time.monotonic() + 20

    def __enter__(self) -> "Tasks":
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if self._pending and self.client.status == "running":
            self.client.cancel(list(self._pending))
        self._pending.clear()
        is_told = isinstance(error, ConnectionError) or not isinstance(error, Exception)
        if not is_told and self.client.status not in ("running", "connecting"):
            raise ConnectionError("the cluster or the client was closed") from error

    def __len__(self) -> int:
        return len(self._pending)

    def cores(self) -> int:
        """The threads of all workers, as of the last second.

        Raises:
            ConnectionError: the scheduler is gone.
        """
        now = time.monotonic()
        if now - self._asked > 1:
            while self.client.status == "connecting":
                time.sleep(0.1)
            if self.client.status != "running":
                raise ConnectionError("the scheduler cannot be reached any more")
            try:
                self._cores = sum(self.client.nthreads().values())
            except OSError:  # the connection broke now; the client tries to get another
                self._cores = 0
            self._asked = time.monotonic()
            if self._cores:
                self._patient_until = self._asked + 20
            elif self._asked > self._patient_until:
                self._patient_until = math.inf
                warnings.warn("the cluster has no workers; waiting for some", RuntimeWarning, stacklevel=4)
        return self._cores

    def enough(self) -> int:
        """As many tasks that no core waits; one where there is none, for clusters that adapt to their load."""
        return 2 * self._cores + 2 if self._cores else 1

    def data(self, value: bytes) -> Future:
        """Data that tasks share. The scheduler keeps it, in case that all workers with it end."""
        with _large_graphs():
            return self.client.submit(bytes, value, pure=False)

    def submit(self, item: Any, work: str, *arguments: Any, data: Future | None = None) -> None:
        """Asks for an item of work.

        The task finds this package only when it runs, and its arguments are bytes until then: the scheduler does
        not need the package, and a worker without it says so instead of ending.
        """
        self._count += 1
        key = (self._name, self._count)
        work_of_worker = (pkgutil.resolve_name, "raio._worker:checked")
        task = (operator.call, work_of_worker, _raio.version(), work, dumps(arguments), data)
        with _large_graphs():
            future = self.client.get({key: task}, key, sync=False)
        self._pending[future] = item
        self._ended.add(future)

    def ended(self, wait_s: float) -> Iterator[tuple[Any, Any]]:
        """Items with their results, or with what went wrong: Lost, Killed, or the worker's exception."""
        until = time.monotonic() + wait_s
        while not (batch := self._ended.next_batch(block=False)) and time.monotonic() < until:
            time.sleep(0.005)
        for future, result in batch:
            if future in self._pending:
                if future.status == "error":
                    result = _explained(future.exception())
                elif future.status != "finished" or isinstance(result, BaseException):
                    result = Lost()
                yield self._remove(future), result
        for future in self._lost():
            yield self._remove(future), Lost()

    def _remove(self, future: Future) -> Any:
        self._finished.pop(future, None)
        item = self._pending.pop(future)
        future.release()
        return item

    def _lost(self) -> list[Future]:
        """Tasks whose worker ended before the result arrived. Dask would try for 30 seconds to reach it."""
        now = time.monotonic()
        for future in self._pending:
            if future.status == "finished":
                self._finished.setdefault(future, now)
        late = [future for future, since in self._finished.items() if now - since > 1]
        if not late or now - self._looked < 1 or self.client.status != "running":
            return []
        self._looked = now
        holders = self.client.who_has(late)
        return [future for future in late if not holders.get(future.key)]


def _large_graphs() -> Any:
    """Without Dask's warning about them."""
    return dask.config.set({"distributed.admin.large-graph-warning-threshold": "1 TB"})


def _explained(error: BaseException) -> BaseException:
    if isinstance(error, KilledWorker):
        return Killed(f"{error.allowed_failures + 1} workers ended while they did the same work, the last of them "
                      f"{error.last_worker.address}. Most likely it needs more memory than a worker has: give workers "
                      "more, or have fewer workers with more threads. Or it crashes; the workers' logs may tell more")
    is_of_raio = isinstance(error, ImportError) and (error.name or "").split(".")[0] == "raio"
    if is_of_raio or isinstance(error, AttributeError) and "raio._worker" in str(error):
        return RuntimeError(f"a worker cannot run raio {_raio.version()} ({error}); install the client's version "
                            "where the workers run")
    return error


def key_of(*parts: Hashable) -> str:
    """A name of data, equal for equal data."""
    digest = hashlib.blake2b(digest_size=16)
    for part in parts:
        digest.update(part if isinstance(part, bytes) else repr(part).encode())
    return digest.hexdigest()
