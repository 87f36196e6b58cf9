"""Programs that a test starts."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any


@contextmanager
def start_program(command: Sequence[str], **options: Any) -> Iterator[subprocess.Popen[str]]:
    """Start a program with text pipes, and kill it at the end if it is still running.

    ``subprocess.Popen`` as a context waits for its program, so a failed assertion inside it would wait for a server forever.
    """
    with subprocess.Popen(command, text=True, **options) as process:
        try:
            yield process
        finally:
            process.kill()
