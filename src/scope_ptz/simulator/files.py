"""Reading files of a pack, which may come from anywhere."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from scope_ptz.errors import PackError


def read_regular_file(path: Path) -> bytes:
    """Return a file's content. Only a regular file is read: opening a pipe in its place would block the program.

    Raises:
        OSError: The file is missing or cannot be read.
        PackError: There is something other than a regular file.
    """
    if not stat.S_ISREG(path.stat().st_mode):
        raise PackError(f"{path} is not a regular file. Restore the pack or bake it again.")
    # A pipe that was put there in the meantime is not waited for.
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | getattr(os, "O_NONBLOCK", 0))) as file:
        return file.read()
