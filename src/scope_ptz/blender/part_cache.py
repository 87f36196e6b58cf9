"""An on-disk cache for the parts of a bake, so that an interrupted bake can resume.

The name of a part's file contains a digest of the part's inputs.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol


class Progress(Protocol):
    """A function called after every step with the part, the number of finished steps, the total, and the elapsed time."""

    def __call__(self, part: str, done: int, total: int, seconds: float) -> None: ...


class PartCache:
    """The folder with the cached parts for one version of a scene."""

    def __init__(self, root: Path, scene_key: str, progress: Progress) -> None:
        self.folder = root / scene_key
        self.folder.mkdir(parents=True, exist_ok=True)
        self._progress = progress

    def part(self, name: str, suffix: str, parameters: dict[str, Any], produce: Callable[[Path], None]) -> Path:
        """Return a part's file. If it is missing, call ``produce`` with the path to write to."""
        key = digest(json.dumps([name, parameters], sort_keys=True))[:12]
        path = self.folder / f"{name.replace('/', '-')}-{key}{suffix}"
        if not path.exists():
            partial = path.with_name(f"unfinished-{path.name}")
            produce(partial)
            partial.replace(path)
        return path

    def steps(self, part: str, total: int) -> Callable[[], None]:
        """Return a function to call after each step of a part."""
        started, done = time.monotonic(), 0
        self._progress(part, 0, total, 0.0)

        def step() -> None:
            nonlocal done
            done += 1
            self._progress(part, done, total, time.monotonic() - started)

        return step

    def step_callback(self, part: str) -> Callable[[int, int], None]:
        """Return a progress callback for an operation that counts its own steps."""
        started = time.monotonic()
        return lambda done, total: self._progress(part, done, total, time.monotonic() - started)


def digest(content: str | bytes) -> str:
    """Return the SHA-256 digest in hex."""
    return hashlib.sha256(content.encode() if isinstance(content, str) else content).hexdigest()
