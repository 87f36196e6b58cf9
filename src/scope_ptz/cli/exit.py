"""Exit codes, error messages, and robust standard streams.

A command that fails prints one line on stderr. Bad input never shows a traceback. The exit codes are:

0    done
1    failed: step limit, budget, planner, camera, perception, Blender, full disk, or a replay with differences
2    wrong input or configuration, or a missing or damaged pack or trace
3    the planner needs clarification
4    the planner refused the instruction
130  cancelled (Ctrl-C, or the signals TERM and HUP)
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

FAILED, BAD_INPUT, UNCLEAR, REFUSED, CANCELLED = 1, 2, 3, 4, 130
_TERMINATION_SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""Signals that ask a program to end. Windows has no HUP."""

_FORCE_EXIT_PRESSES = 3  # this many presses of Ctrl-C end the program without clean-up
EXIT_CODES = "Exit codes: 0 done, 1 failed, 2 wrong input or a damaged file, 3 clarification needed, 4 refused, 130 cancelled."

_BY_OUTCOME = {"answered": 0, "clarification": UNCLEAR, "refused": REFUSED, "cancelled": CANCELLED}
_ASCII = {"›": ">", "°": " deg", "·": "-", "“": '"', "”": '"', "‘": "'", "’": "'", "…": "...", "×": "x", "–": "-", "—": "-"}


def exit_code(outcome: str) -> int:
    """Return the exit code for a run's outcome."""
    return _BY_OUTCOME.get(outcome, FAILED)


def put(text: str) -> None:
    """Print one line on stdout without formatting."""
    sys.stdout.write(text + "\n")


def put_json(content: Any, *, indent: int | None = None) -> None:
    """Print JSON on stdout. If the encoding of stdout is not Unicode, characters outside ASCII are escaped as ``\\uXXXX``."""
    put(json.dumps(content, indent=indent, ensure_ascii=not _is_unicode(sys.stdout)))


def print_error(message: str) -> None:
    """Print one line on stderr."""
    sys.stderr.write(f"scope: {message}\n")


class _LogLines(logging.Handler):
    """Prints the package's warnings as lines on stderr."""

    def emit(self, record: logging.LogRecord) -> None:
        print_error(record.getMessage())


def _show_warnings() -> None:
    logger = logging.getLogger("scope_ptz")
    if not any(isinstance(handler, _LogLines) for handler in logger.handlers):
        logger.addHandler(_LogLines(logging.WARNING))
        # Set the level of this logger, because libraries such as the evaluation engine change the root logger's level.
        logger.setLevel(logging.WARNING)
        logger.propagate = False


@contextmanager
def exit_on_error(*, as_json: bool = False) -> Iterator[None]:
    """Convert SCOPE's errors and Ctrl-C to a message on stderr and an exit code.

    Args:
        as_json: Also print the error as a JSON object on stdout.
    """
    _show_warnings()
    try:
        yield
    except ScopeError as error:
        bad_input = isinstance(error, InputError | PackError | TraceError | ToolCallError)
        print_error(str(error))
        if as_json:
            put_json({"error": str(error)})
        sys.exit(BAD_INPUT if bad_input else FAILED)
    except KeyboardInterrupt:
        _ignore_interrupts()
        print_error("cancelled.")
        sys.exit(CANCELLED)


def run_until_interrupted(work: Callable[[], Awaitable[None]]) -> bool:
    """Run a coroutine function, and cancel it at the first Ctrl-C. The signals TERM and HUP do the same.

    The function can then stop the camera and record how it ended. A second Ctrl-C is ignored, and a third one ends the program
    immediately.

    Returns:
        Whether it was cancelled.
    """
    import asyncio

    import anyio

    async def supervised() -> bool:
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

    return anyio.run(supervised)


def run_async(work: Callable[[], Awaitable[None]]) -> None:
    """Run a coroutine function. Ctrl-C cancels it, as in ``run_until_interrupted``.

    Raises:
        KeyboardInterrupt: It was cancelled.
    """
    if run_until_interrupted(work):
        raise KeyboardInterrupt


@contextmanager
def handle_interrupts(handler: Callable[..., None] | signal.Handlers) -> Iterator[None]:
    """Replace the handlers of Ctrl-C and of the signals TERM and HUP within the block.

    A signal that is already ignored, such as HUP under ``nohup``, stays ignored. Outside the main thread, no handler changes.
    """
    main = threading.current_thread() is threading.main_thread()
    found = {number: signal.getsignal(number) for number in _TERMINATION_SIGNALS if main}
    before = {number: current for number, current in found.items() if current not in (signal.SIG_IGN, None)}
    try:
        for number in before:
            signal.signal(number, handler)
        yield
    finally:
        for number, current in before.items():
            signal.signal(number, current)


@contextmanager
def safe_streams() -> Iterator[None]:
    """Make standard streams safe even if they are closed, cannot be written, are broken pipes, or do not use UTF-8.

    A closed stream is replaced by the null device. Output to a broken pipe (``scope tools | head``) is dropped silently and does
    not change the exit code. If output cannot be written for another reason, such as a full disk, the exit code is 1.
    """
    _open_closed_descriptors()
    previous = sys.stdin, sys.stdout, sys.stderr
    stdin = sys.stdin if sys.stdin is not None else open(os.devnull, encoding="utf-8")  # noqa: SIM115, PTH123
    stdout, stderr = (_Output(stream or open(os.devnull, "w", encoding="utf-8")) for stream in previous[1:])  # noqa: SIM115, PTH123
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
        sys.stdin, sys.stdout, sys.stderr = previous
        if stdout.failure is not None and sys.exc_info()[0] in (None, SystemExit):
            sys.exit(FAILED)


def has_input() -> bool:
    """Return whether the program has a standard input; False if it was closed at the start."""
    return getattr(sys.stdin, "name", None) != os.devnull


class _Output:
    """A text stream that never raises when writing fails. ``failure`` is the first error other than a broken pipe."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self.failure: OSError | None = None

    def write(self, text: str) -> int:
        try:
            return self._stream.write(text)
        except OSError as error:
            self._give_up(error)
            return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except OSError as error:
            self._give_up(error)

    def _give_up(self, error: OSError) -> None:
        """Redirect all further and buffered output to the null device."""
        if not isinstance(error, BrokenPipeError) and self.failure is None:
            self.failure = error
        with suppress(OSError, ValueError):
            null_device = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null_device, self._stream.fileno())
            os.close(null_device)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def _open_closed_descriptors() -> None:
    """Open the null device for closed standard descriptors, so that no other file gets their numbers and receives output."""
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            with suppress(OSError):
                os.open(os.devnull, os.O_RDWR)


def _set_error_handlers(stdin: TextIO, *outputs: _Output) -> None:
    """Set the error handlers: outputs replace characters that they cannot encode, and the input replaces invalid bytes."""
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
    """Replace characters with an ASCII equivalent or a question mark. This is a codec error handler."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(_ASCII.get(c, "?") for c in error.object[error.start : error.end]), error.end


def _is_unicode(stream: Any) -> bool:
    return (getattr(stream, "encoding", None) or "utf-8").lower().replace("-", "").startswith("utf")


def decode_arguments(arguments: list[str]) -> list[str]:
    """Decode the arguments that the locale's encoding could not decode as UTF-8."""
    return [os.fsencode(text).decode("utf-8", "replace") if _has_surrogates(text) else text for text in arguments]


def _has_surrogates(text: str) -> bool:
    return any("\udc80" <= c <= "\udcff" for c in text)


def _ignore_interrupts() -> None:
    """Ignore Ctrl-C from now on. The program is about to end, and another Ctrl-C would only show a traceback."""
    with suppress(ValueError):  # signal handlers can only be set in the main thread
        signal.signal(signal.SIGINT, signal.SIG_IGN)
