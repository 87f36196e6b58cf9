"""Read files from packs, which may come from untrusted sources."""

from __future__ import annotations

from pathlib import Path

from scope_ptz import regular_files
from scope_ptz.errors import PackError


def read_regular_file(path: Path) -> bytes:
    """Return the contents of a file in a pack.

    Raises:
        OSError: The file is missing or cannot be read.
        PackError: The path is not a regular file.
    """
    try:
        return regular_files.read_regular_file(path)
    except regular_files.NotARegularFileError as error:
        raise PackError(f"{path} is not a regular file. Restore the pack or bake it again.") from error
