"""Exit codes, error messages, cancellation by Ctrl-C and signals, and robust standard streams.

A command that fails prints one line on stderr. Invalid input never causes a traceback. The exit codes are:

0    done
1    failed: step limit, budget, planner, camera, perception, Blender, full disk, or a replay with differences
2    invalid input or configuration, or a missing or damaged pack or trace
3    the planner needs clarification
4    the planner refused the instruction
130  cancelled (Ctrl-C, SIGTERM or SIGHUP)
"""

from __future__ import annotations

import codecs
import json
import logging
import os
import signal
import sys
import threading
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, TextIO, cast

from scope_ptz.errors import InputError, PackError, ScopeError, ToolCallError, TraceError

FAILED, BAD_INPUT, CLARIFICATION_NEEDED, REFUSED, CANCELLED = 1, 2, 3, 4, 130
_TERMINATION_SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""Signals that request termination. SIGHUP does not exist on Windows."""

_FORCE_EXIT_PRESSES = 3  # number of Ctrl-C presses after which the program ends without clean-up
EXIT_CODES = "Exit codes: 0 done, 1 failed, 2 invalid input or a damaged file, 3 clarification needed, 4 refused, 130 cancelled."

_CODE_BY_OUTCOME = {"answered": 0, "clarification": CLARIFICATION_NEEDED, "refused": REFUSED, "cancelled": CANCELLED}
_TO_ASCII = {"›": ">", "°": " deg", "·": "-", "“": '"', "”": '"', "‘": "'", "’": "'", "…": "...", "×": "x", "–": "-", "—": "-"}


def exit_code(outcome: str) -> int:
    """Return the exit code for a run's outcome."""
    return _CODE_BY_OUTCOME.get(outcome, FAILED)


def put(text: str) -> None:
    """Print one line on stdout without formatting."""
    sys.stdout.write(text + "\n")


def put_json(content: Any, *, indent: int | None = None) -> None:
    """Print JSON on stdout. If the encoding of stdout is not Unicode, characters outside ASCII are escaped as ``\\uXXXX``."""
    put(json.dumps(content, indent=indent, ensure_ascii=not _is_unicode(sys.stdout)))


def print_error(message: str) -> None:
    """Print one line on stderr."""
    sys.stderr.write(f"scope: {message}\n")


class _WarningHandler(logging.Handler):
    """A logging handler that prints the package's warnings on stderr."""

    def emit(self, record: logging.LogRecord) -> None:
        print_error(record.getMessage())


def _show_warnings() -> None:
    logger = logging.getLogger("scope_ptz")
    if not any(isinstance(handler, _WarningHandler) for handler in logger.handlers):
        logger.addHandler(_WarningHandler(logging.WARNING))
        # Set the level of this logger, because libraries such as the evaluation engine change the root logger's level.
        logger.setLevel(logging.WARNING)
        logger.propagate = False


@contextmanager
def exit_on_error(*, as_json: bool = False) -> Iterator[None]:
    """Convert SCOPE's errors and Ctrl-C to a message on stderr and an exit code.

    Args:
        as_json: Whether to print the error as a JSON object on stdout too.
    """
    _show_warnings()
    try:
        yield
    except ScopeError as error:
        is_bad_input = isinstance(error, InputError | PackError | TraceError | ToolCallError)
        print_error(str(error))
        if as_json:
            put_json({"error": str(error)})
        sys.exit(BAD_INPUT if is_bad_input else FAILED)
    except KeyboardInterrupt:
        _ignore_interrupts()
        print_error("cancelled.")
        sys.exit(CANCELLED)


def run_until_interrupted(work: Callable[[], Awaitable[None]]) -> bool:
    """Run a coroutine function, and cancel it on the first Ctrl-C, SIGTERM or SIGHUP.

    After the cancellation, the function can stop the camera and record how the run ended. A second Ctrl-C is ignored, and a third
    ends the program immediately.

    Returns:
        Whether the function was cancelled.
    """
    import asyncio

    import anyio

    async def run_supervised() -> bool:
        loop, presses = asyncio.get_running_loop(), 0
        with anyio.CancelScope() as scope:

            def interrupt(*_: object) -> None:
                nonlocal presses
                presses += 1
                if presses == 1:
                    loop.call_soon_threadsafe(scope.cancel)
                elif presses == _FORCE_EXIT_PRESSES:
                    os._exit(CANCELLED)

            with handle_interrupts(interrupt):
                await work()
        return scope.cancelled_caught

    return anyio.run(run_supervised)


def run_async(work: Callable[[], Awaitable[None]]) -> None:
    """Run a coroutine function, which Ctrl-C cancels as in ``run_until_interrupted``.

    Raises:
        KeyboardInterrupt: The function was cancelled.
    """
    if run_until_interrupted(work):
        raise KeyboardInterrupt


@contextmanager
def handle_interrupts(handler: Callable[..., None] | signal.Handlers) -> Iterator[None]:
    """Replace the handlers for SIGINT (Ctrl-C), SIGTERM and SIGHUP within a block.

    A signal that is already ignored, such as SIGHUP under ``nohup``, stays ignored. Outside the main thread, no handler is changed.
    """
    is_main_thread = threading.current_thread() is threading.main_thread()
    current_handlers = {signal_number: signal.getsignal(signal_number) for signal_number in _TERMINATION_SIGNALS if is_main_thread}
    replaced = {
        signal_number: current for signal_number, current in current_handlers.items() if current not in (signal.SIG_IGN, None)
    }
    try:
        for signal_number in replaced:
            signal.signal(signal_number, handler)
        yield
    finally:
        for signal_number, current in replaced.items():
            signal.signal(signal_number, current)


@contextmanager
def safe_streams() -> Iterator[None]:
    """Make standard streams safe to use even if they are closed, not writable, broken pipes, or not UTF-8.

    A closed stream is replaced with the null device. Output to a broken pipe (``scope tools | head``) is discarded silently and
    does not affect the exit code. If output cannot be written for another reason, such as a full disk, the exit code is 1.
    """
    _open_closed_descriptors()
    previous_streams = sys.stdin, sys.stdout, sys.stderr
    stdin = sys.stdin if sys.stdin is not None else open(os.devnull, encoding="utf-8")  # noqa: SIM115, PTH123
    stdout, stderr = (_Output(stream or open(os.devnull, "w", encoding="utf-8")) for stream in previous_streams[1:])  # noqa: SIM115, PTH123
    _set_error_handlers(stdin, stdout, stderr)
    sys.stdin, sys.stdout, sys.stderr = stdin, cast(TextIO, stdout), cast(TextIO, stderr)
    try:
        yield
    except KeyboardInterrupt:
        _ignore_interrupts()
        print_error("cancelled.")
        sys.exit(CANCELLED)
    finally:
        stdout.flush()
        if stdout.failure is not None:
            print_error(f"the output could not be written: {stdout.failure.strerror or stdout.failure}.")
        stderr.flush()
        sys.stdin, sys.stdout, sys.stderr = previous_streams
        if stdout.failure is not None and sys.exc_info()[0] in (None, SystemExit):
            sys.exit(FAILED)


def has_input() -> bool:
    """Return whether standard input is available. It is not if it was closed when the program started."""
    return getattr(sys.stdin, "name", None) != os.devnull


class _Output:
    """A text stream that never raises an error when it is written to. ``failure`` is the first error other than a broken pipe."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self.failure: OSError | None = None

    def write(self, text: str) -> int:
        try:
            return self._stream.write(text)
        except OSError as error:
            self._discard_output(error)
            return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except OSError as error:
            self._discard_output(error)

    def _discard_output(self, error: OSError) -> None:
        """Redirect buffered and further output to the null device."""
        if not isinstance(error, BrokenPipeError) and self.failure is None:
            self.failure = error
        with suppress(OSError, ValueError):
            null_device = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null_device, self._stream.fileno())
            os.close(null_device)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def _open_closed_descriptors() -> None:
    """Open the null device for closed standard descriptors, so that no other file can get their numbers and receive output."""
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            with suppress(OSError):
                os.open(os.devnull, os.O_RDWR)


def _set_error_handlers(stdin: TextIO, *outputs: _Output) -> None:
    """Make outputs replace characters that they cannot encode, and make the input replace invalid bytes."""
    codecs.register_error("scope-ascii", _ascii_replacement)
    for output in outputs:
        if not _is_unicode(output) and hasattr(output, "reconfigure"):
            output.reconfigure(errors="scope-ascii")
        elif hasattr(output, "reconfigure"):
            output.reconfigure(errors="replace")
    if hasattr(stdin, "reconfigure") and stdin.encoding.lower() in ("ascii", "us-ascii", "ansi_x3.4-1968"):
        stdin.reconfigure(encoding="utf-8", errors="replace")
    elif hasattr(stdin, "reconfigure"):
        stdin.reconfigure(errors="replace")


def _ascii_replacement(error: UnicodeError) -> tuple[str, int]:
    """Replace characters with ASCII equivalents or question marks. This is a codec error handler."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(_TO_ASCII.get(c, "?") for c in error.object[error.start : error.end]), error.end


def _is_unicode(stream: Any) -> bool:
    return (getattr(stream, "encoding", None) or "utf-8").lower().replace("-", "").startswith("utf")


def decode_arguments(arguments: list[str]) -> list[str]:
    """Decode arguments as UTF-8 if the locale's encoding could not decode them."""
    return [os.fsencode(text).decode("utf-8", "replace") if _has_surrogates(text) else text for text in arguments]


def _has_surrogates(text: str) -> bool:
    return any("\udc80" <= c <= "\udcff" for c in text)


def _ignore_interrupts() -> None:
    """Ignore Ctrl-C from now on, because the program is about to end, and another Ctrl-C would only cause a traceback."""
    with suppress(ValueError):  # signal handlers can only be set in the main thread
        signal.signal(signal.SIGINT, signal.SIG_IGN)
