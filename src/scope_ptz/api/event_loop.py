"""An event loop in a separate thread, for the synchronous session."""

from __future__ import annotations

import threading
from collections.abc import Awaitable, Callable, Iterator
from concurrent.futures import CancelledError, Future
from functools import partial
from queue import SimpleQueue
from typing import TypeVar

import anyio
from anyio.from_thread import BlockingPortal

EXIT_CHECK_INTERVAL_S = 0.5  # seconds between checks of whether the main thread has ended
_T = TypeVar("_T")
_E = TypeVar("_E")


class EventLoopThread:
    """Runs coroutines in another thread, so that synchronous code works inside a running event loop, such as Jupyter's.

    ``stop`` ends the thread. The thread also ends when the main thread ends, because the interpreter would otherwise wait at exit
    for a session that was never closed.
    """

    def __init__(self, at_exit: Callable[[], Awaitable[None]]) -> None:
        """Start the thread.

        Args:
            at_exit: Coroutine function that runs in the event loop before the thread ends.
        """
        self._at_exit = at_exit
        self._ready: Future[BlockingPortal] = Future()
        self._stop: anyio.Event | None = None
        self._thread = threading.Thread(target=self._run, daemon=True, name="scope-ptz session")
        self._thread.start()
        self._portal = self._ready.result()

    def _run(self) -> None:
        try:
            anyio.run(self._serve)
        except BaseException as error:  # any failure must reach the thread that waits for the portal
            if not self._ready.done():
                self._ready.set_exception(error)

    async def _serve(self) -> None:
        self._stop = anyio.Event()
        async with BlockingPortal() as portal:
            self._ready.set_result(portal)
            while not self._stop.is_set() and threading.main_thread().is_alive():
                with anyio.move_on_after(EXIT_CHECK_INTERVAL_S):
                    await self._stop.wait()
            await self._at_exit()

    def call(self, work: Callable[[], Awaitable[_T]]) -> _T:
        """Run a coroutine, and return its result.

        An exception in the waiting thread, such as KeyboardInterrupt, cancels the coroutine. The exception is raised again after
        the coroutine has finished, so that a cancelled run has a complete trace.
        """
        future, finished = self._start(work)
        try:
            return future.result()
        except CancelledError:
            raise
        except BaseException:
            if not future.done():
                future.cancel()
                finished.wait()
            raise

    def iterate(self, work: Callable[[Callable[[_E], None]], Awaitable[object]]) -> Iterator[_E]:
        """Run a coroutine, and yield its events as they happen.

        The coroutine starts when the first event is requested. Closing the iterator early cancels the coroutine and waits until it
        has finished. An exception of the coroutine is raised after its last event.

        Args:
            work: Coroutine function that passes its events to the listener that it is given.
        """
        events: SimpleQueue[_E | None] = SimpleQueue()
        future, finished = self._start(partial(work, events.put))
        future.add_done_callback(lambda _: events.put(None))
        try:
            while (event := events.get()) is not None:
                yield event
            future.result()
        finally:
            if not future.done():
                future.cancel()
                finished.wait()

    def _start(self, work: Callable[[], Awaitable[_T]]) -> tuple[Future[_T], threading.Event]:
        """Start a coroutine. Return its future and an event that is set when it has finished or its cancellation is complete."""
        finished = threading.Event()

        async def run() -> _T:
            try:
                return await work()
            finally:
                finished.set()

        return self._portal.start_task_soon(run), finished

    def call_function(self, function: Callable[[], None]) -> None:
        """Run a function in the event loop's thread."""
        self._portal.call(function)

    def stop(self) -> None:
        """Stop the thread, and wait until it has ended. Calling this method again has no effect."""
        if self._thread.is_alive() and self._stop is not None:
            self._portal.call(self._stop.set)
            self._thread.join()


def run_in_thread(work: Callable[[], Awaitable[_T]]) -> _T:
    """Run a coroutine in a new event loop, even if an event loop is already running in the calling thread."""

    async def do_nothing() -> None: ...

    loop = EventLoopThread(do_nothing)
    try:
        return loop.call(work)
    finally:
        loop.stop()
