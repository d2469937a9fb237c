"""Where the flights of a sweep fly: this thread, threads, processes of this machine, or Dask's workers anywhere."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing.synchronize import Semaphore
from typing import Any

from sailviz.compiled import waiting
from sailviz.sweeps.store import SweepError
from sailviz.words import nearest

ENGINES = ("processes", "threads", "serial", "dask")


class SerialExecutor(Executor):
    """Does what is submitted at once, in this thread."""

    _max_workers = 1

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """A future that is done."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


def processes(workers: int | None = None) -> ProcessPoolExecutor:
    """Processes that start afresh on every system, so that no thread or lock of this one is copied, and that end with
    it, however it ends."""
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(
        workers or os.cpu_count() or 1,
        mp_context=context,
        initializer=_begin_worker,
        initargs=(waiting.listener(), context.Semaphore(1)),
    )


def _begin_worker(tell: Callable[[], None] | None, turn: Semaphore) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the parent decides
    threading.Thread(target=_end_with_parent, daemon=True).start()
    if tell is not None:
        waiting.when_long(lambda: _tell_once(tell, turn))


def _tell_once(tell: Callable[[], None], turn: Semaphore) -> None:
    """All workers compile the same at the same time: the first one to say so speaks for them."""
    if turn.acquire(block=False):
        tell()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
    os._exit(1)


def abandon(executor: Executor) -> None:
    """Drop what waits, and end our own processes in the middle of what they do."""
    running = list((getattr(executor, "_processes", None) or {}).values())
    executor.shutdown(wait=False, cancel_futures=True)
    for process in running if isinstance(executor, ProcessPoolExecutor) else ():
        process.terminate()


def check_engine(name: str) -> tuple[str, str]:
    """(kind, address) of an engine's name. SweepError if there is none."""
    kind, _, address = name.partition("://")
    if kind not in ENGINES or (address and kind != "dask"):
        raise SweepError(f'there is no engine "{name}". {nearest(kind, ENGINES)} Dask elsewhere is dask://HOST:PORT.')
    return kind, address


@contextmanager
def engine(name: str, workers: int | None = None) -> Iterator[Executor | None]:
    """The executor of an engine's name; None for processes, which the sweep itself starts and renews.

    name : "processes", "threads", "serial", "dask" (a cluster on this machine) or "dask://host:port" of a scheduler.
    """
    kind, address = check_engine(name)
    if kind == "processes":
        yield None
    elif kind == "serial":
        yield SerialExecutor()
    elif kind == "threads":
        with ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
            yield pool
    else:
        with _dask(address, workers) as client, client.get_executor() as executor:
            yield executor


@contextmanager
def _dask(address: str, workers: int | None) -> Iterator[Any]:
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise SweepError('the engine "dask" needs the extra "dask": pip install "sailviz[dask]"') from None
    if address:
        try:
            client = Client(f"tcp://{address}", timeout=10)
        except (OSError, TimeoutError, ValueError) as error:
            raise SweepError(f"no Dask scheduler answers at {address}: {error}") from None
        with client:
            yield client
        return
    count = workers or os.cpu_count() or 1
    with (
        LocalCluster(n_workers=count, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        if (tell := waiting.listener()) is not None:
            first, *_ = client.scheduler_info()["workers"]
            client.run(waiting.when_long, tell, workers=[first])  # one speaks for all
        yield client


def workers_of(executor: Executor) -> int:
    """How many flights an executor can fly at once, as far as it tells."""
    client = getattr(executor, "_client", None)
    if client is not None and hasattr(client, "ncores"):
        return max(1, sum(client.ncores().values()))
    return getattr(executor, "_max_workers", None) or os.cpu_count() or 1
