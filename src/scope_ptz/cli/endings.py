"""How commands end: one clear line on stderr and an exit code, never a traceback for bad input.

0    done; a clarifying question or a refusal is an answer too
1    the run or the machinery failed: step limit, budget, planner, camera, Blender; a replay that came out different
2    what was typed or configured is wrong, or a pack or trace is missing or damaged
130  cancelled (Ctrl-C)
"""

from __future__ import annotations

import json
import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from typing import Any, TextIO, cast

from scope_ptz.errors import InputError, PackError, ScopeError, ToolCallError, TraceError

FAILED, BAD_INPUT, CANCELLED = 1, 2, 130

_BY_OUTCOME = {"answered": 0, "clarification": 0, "refused": 0, "cancelled": CANCELLED}


def exit_code(outcome: str) -> int:
    """Exit code of a run's outcome."""
    return _BY_OUTCOME.get(outcome, FAILED)


class _Patient:
    """Stdout that does not mind when its reader has seen enough (`scope tools | head`): the command goes on to its end, because
    what it finds out decides the exit code."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        try:
            return self._stream.write(text)
        except BrokenPipeError:
            self._turn_away()
            return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except BrokenPipeError:
            self._turn_away()

    def _turn_away(self) -> None:
        """Whatever follows, and what is still held back, goes nowhere."""
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._stream.fileno())
        os.close(nowhere)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def put(text: str) -> None:
    """One line on stdout, as it is."""
    sys.stdout.write(text + "\n")


def put_json(content: Any, *, indent: int | None = None) -> None:
    """JSON on stdout, and nothing else."""
    put(json.dumps(content, indent=indent, ensure_ascii=False))


def complain(message: str) -> None:
    """One line on stderr."""
    sys.stderr.write(f"scope: {message}\n")


class _LogLines(logging.Handler):
    """Prints the warnings of the package as lines on stderr."""

    def emit(self, record: logging.LogRecord) -> None:
        complain(record.getMessage())


def _show_warnings() -> None:
    logger = logging.getLogger("scope_ptz")
    if not any(isinstance(handler, _LogLines) for handler in logger.handlers):
        logger.addHandler(_LogLines(logging.WARNING))
        logger.propagate = False


@contextmanager
def ending(*, as_json: bool = False) -> Iterator[None]:
    """Turn SCOPE's own errors and Ctrl-C into the end of the program. A closed pipe changes nothing about it."""
    _show_warnings()
    patient = _Patient(sys.stdout)
    with redirect_stdout(cast(TextIO, patient)):
        try:
            with _told_as_code(as_json=as_json):
                yield
        finally:
            patient.flush()


@contextmanager
def _told_as_code(*, as_json: bool) -> Iterator[None]:
    try:
        yield
    except ScopeError as error:
        bad_input = isinstance(error, InputError | PackError | TraceError | ToolCallError)
        complain(str(error))
        if as_json:
            put_json({"error": str(error)})
        sys.exit(BAD_INPUT if bad_input else FAILED)
    except KeyboardInterrupt:
        complain("cancelled.")
        sys.exit(CANCELLED)
