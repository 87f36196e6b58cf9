"""An on-disk cache of decoded pictures, so that later processes need not decode them again.

A sheet of decoded pictures is a sparse file that is mapped into memory, so only the parts that a view samples are read. A list
file next to it names the complete pictures. The checksums of the pack's own picture files are still verified before use.
"""

from __future__ import annotations

import hashlib
import mmap
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import __version__ as pillow_version

try:
    import fcntl
except ImportError:  # Windows: files are not sparse by default, and mapped files cannot be removed
    fcntl = None  # type: ignore[assignment]

MAX_BYTES = 1_500_000_000
"""Maximum disk space for all sheets, in bytes. Beyond it, the least recently used sheets are removed."""

SPARE_BYTES = 1_000_000_000
"""Minimum free disk space in bytes. If less is free, nothing is cached."""

_SHEET, _LIST, _BLOB = ".sheet", ".list", ".blob"
_LINE = re.compile(r"(\d{1,9}) (\d{1,9})")
_BLOCK_BYTES = 512  # unit of ``st_blocks``


class PictureCache:
    """A folder of decoded pictures.

    Args:
        folder: The folder, which is created on demand. If it cannot be written to, nothing is cached.
        version: Version of the code that fills sheets. Sheets from other versions are not used.
    """

    def __init__(self, folder: Path, version: str) -> None:
        self._folder = folder
        self._version = f"{version} {cv2.__version__} {pillow_version} {np.dtype(np.uint16).str}"

    def name(self, *parts: object) -> str:
        """Return a file name for contents that are determined by ``parts``."""
        return hashlib.sha256(repr((self._version, parts)).encode()).hexdigest()[:32]

    def sheet(self, name: str, shape: tuple[int, ...], dtype: type[np.generic]) -> CachedSheet | None:
        """Return a sheet; None if it cannot be cached. A new sheet is empty."""
        size = int(np.prod(shape)) * np.dtype(dtype).itemsize
        path = self._folder / (name + _SHEET)
        try:
            if not self._has_room(path, size):
                return None
            return CachedSheet(path, size, shape, dtype)
        except OSError:
            return None

    def blob(self, name: str) -> bytes | None:
        """Return the bytes that ``store_blob`` stored under a name; None if there are none or they are damaged."""
        path = self._folder / (name + _BLOB)
        try:
            content = path.read_bytes()
            os.utime(path)
        except OSError:
            return None
        digest, content = content[:32], content[32:]
        return content if hashlib.sha256(content).digest() == digest else None

    def store_blob(self, name: str, content: bytes) -> None:
        """Store bytes under a name. If they cannot be written, nothing is stored."""
        path = self._folder / (name + _BLOB)
        new = path.with_suffix(f".{os.getpid()}.new")
        with suppress(OSError):
            if self._has_room(path, len(content)):
                new.write_bytes(hashlib.sha256(content).digest() + content)
                new.replace(path)

    def _has_room(self, path: Path, size: int) -> bool:
        """Create the folder, remove old files, and return whether there is room for a file of this size."""
        if fcntl is None:
            return False
        self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if path.exists():
            size = max(0, size - path.stat().st_blocks * _BLOCK_BYTES)
        else:
            self._remove_oldest()
        # Writing to a mapped file on a full disk kills the process, so there must be room for the whole sheet.
        return shutil.disk_usage(self._folder).free >= size + SPARE_BYTES

    def _remove_oldest(self) -> None:
        entries = [(path, path.stat()) for path in self._folder.iterdir() if path.suffix in (_SHEET, _BLOB)]
        total = sum(entry.st_blocks * _BLOCK_BYTES for _, entry in entries)
        for path, entry in sorted(entries, key=lambda pair: pair[1].st_mtime_ns):
            if total <= MAX_BYTES:
                return
            path.with_suffix(_LIST).unlink(missing_ok=True)
            path.unlink(missing_ok=True)
            total -= entry.st_blocks * _BLOCK_BYTES


class CachedSheet:
    """A sheet in a file. Several processes may fill and read it at the same time.

    Attributes:
        array: The pixels. Parts that no process has filled are zero.
    """

    def __init__(self, path: Path, size: int, shape: tuple[int, ...], dtype: type[np.generic]) -> None:
        self._path, self._list = path, path.with_suffix(_LIST)
        with path.open("a+b") as file, self._lock_list() as list_file:
            if os.fstat(file.fileno()).st_size != size:
                list_file.truncate(0)
                file.truncate(size)
            os.utime(path)
            self._memory = mmap.mmap(file.fileno(), size)
        self._locked_list: IO[str] | None = None
        self.array: NDArray[Any] = np.frombuffer(self._memory, dtype).reshape(shape)

    def complete_pictures(self) -> set[tuple[int, int]]:
        """Return the complete pictures as (picture index, scale index) pairs."""
        try:
            *lines, _ = self._list.read_text(encoding="ascii").split("\n")  # the last line may be incomplete
        except (OSError, ValueError):
            return set()
        return {(int(match[1]), int(match[2])) for line in lines if (match := _LINE.fullmatch(line))}

    @contextmanager
    def lock_for_filling(self) -> Iterator[None]:
        """Prevent other processes from filling the sheet inside this context. Contexts may be nested, but are not thread-safe."""
        if self._locked_list is not None:
            yield
            return
        with self._lock_list() as list_file:
            self._locked_list = list_file
            try:
                yield
            finally:
                self._locked_list = None

    def mark_complete(self, picture: int, scale: int) -> None:
        """Write a picture's pixels to disk, then record that the picture is complete. Call this inside ``lock_for_filling``."""
        # mmap.flush would hold the interpreter's lock, and all other threads would wait for the disk.
        # Another process may have removed the file because it was the oldest.
        with suppress(FileNotFoundError), self._path.open("rb") as file:
            os.fsync(file.fileno())
        if self._locked_list is not None:
            self._locked_list.write(f"{picture} {scale}\n")
            self._locked_list.flush()

    @contextmanager
    def _lock_list(self) -> Iterator[IO[str]]:
        """Open the list file with an exclusive lock, which is released when the file is closed."""
        with self._list.open("a", encoding="ascii") as list_file:
            fcntl.flock(list_file, fcntl.LOCK_EX)
            yield list_file
