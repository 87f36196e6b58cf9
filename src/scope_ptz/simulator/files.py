"""Read files of packs, which may come from untrusted sources."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from scope_ptz.errors import PackError


def read_regular_file(path: Path) -> bytes:
    """Return a file's content. Only regular files are read, because opening a pipe would block the program.

    Raises:
        OSError: The file is missing or cannot be read.
        PackError: The path is not a regular file.
    """
    if not stat.S_ISREG(path.stat().st_mode):
        raise PackError(f"{path} is not a regular file. Restore the pack or bake it again.")
    # O_NONBLOCK: do not wait if the file was replaced with a pipe after the check.
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | getattr(os, "O_NONBLOCK", 0))) as file:
        return file.read()
