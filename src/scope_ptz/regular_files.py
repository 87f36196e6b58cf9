"""Read files that may come from untrusted sources. Only regular files are read, because opening a pipe would block the program."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path


class NotARegularFileError(OSError):
    """The path is a pipe, a socket or a device."""


def check_regular_file(path: Path) -> None:
    """Raise an error if a path is a pipe, a socket or a device.

    Raises:
        NotARegularFileError: The path is a pipe, a socket or a device.
        OSError: The path is missing or cannot be accessed.
    """
    mode = path.stat().st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):  # opening a folder raises an error anyway
        raise NotARegularFileError(errno.EINVAL, "it is not a regular file")


def read_regular_file(path: Path) -> bytes:
    """Return a file's content.

    Raises:
        NotARegularFileError: The path is a pipe, a socket or a device.
        OSError: The file is missing or cannot be read.
    """
    check_regular_file(path)
    # O_NONBLOCK: do not wait if the file was replaced with a pipe after the check.
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | getattr(os, "O_NONBLOCK", 0))) as file:
        return file.read()
