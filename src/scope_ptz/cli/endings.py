"""How commands end: one clear line on stderr and an exit code, never a traceback for bad input.

0    done; a clarifying question or a refusal is an answer too
1    the run or the machinery failed: step limit, budget, planner, camera, Blender; a replay that came out different
2    what was typed or configured is wrong, or a pack or trace is missing or damaged
130  cancelled (Ctrl-C)
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from scope_ptz.errors import InputError, PackError, ScopeError, ToolCallError, TraceError

FAILED, BAD_INPUT, CANCELLED = 1, 2, 130

_BY_OUTCOME = {"answered": 0, "clarification": 0, "refused": 0, "cancelled": CANCELLED}


def exit_code(outcome: str) -> int:
    """Exit code of a run's outcome."""
    return _BY_OUTCOME.get(outcome, FAILED)


def put(text: str) -> None:
    """One line on stdout, as it is."""
    sys.stdout.write(text + "\n")


def put_json(content: Any, *, indent: int | None = None) -> None:
    """JSON on stdout, and nothing else."""
    put(json.dumps(content, indent=indent, ensure_ascii=False))


def complain(message: str) -> None:
    """One line on stderr."""
    sys.stderr.write(f"scope: {message}\n")


@contextmanager
def ending(*, as_json: bool = False) -> Iterator[None]:
    """Turn SCOPE's own errors, Ctrl-C and a closed pipe into the end of the program."""
    try:
        yield
        sys.stdout.flush()
    except ScopeError as error:
        bad_input = isinstance(error, InputError | PackError | TraceError | ToolCallError)
        complain(str(error))
        if as_json:
            put_json({"error": str(error)})
        sys.exit(BAD_INPUT if bad_input else FAILED)
    except KeyboardInterrupt:
        complain("cancelled.")
        sys.exit(CANCELLED)
    except BrokenPipeError:
        # Whoever read the output has seen enough (`scope tools | head`); stdout must not complain again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
