"""The unfinished bake on disk: every part is a file named by what it depends on, so that a killed bake goes on where it stopped."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol


class Progress(Protocol):
    """Told after every step: which part, how much of it is done, and how long the part has taken so far."""

    def __call__(self, part: str, done: int, total: int, seconds: float) -> None: ...


class Workshop:
    """A folder of parts for one state of a scene."""

    def __init__(self, root: Path, scene_key: str, progress: Progress) -> None:
        self.folder = root / scene_key
        self.folder.mkdir(parents=True, exist_ok=True)
        self._progress = progress

    def part(self, name: str, suffix: str, parameters: dict[str, Any], produce: Callable[[Path], None]) -> Path:
        """The finished file of a part, made by ``produce`` (to a path that it is given) unless it is there already."""
        stamp = digest(json.dumps([name, parameters], sort_keys=True))[:12]
        path = self.folder / f"{name.replace('/', '-')}-{stamp}{suffix}"
        if not path.exists():
            partial = path.with_name(f"unfinished-{path.name}")
            produce(partial)
            partial.replace(path)
        return path

    def steps(self, part: str, total: int) -> Callable[[], None]:
        """A counter to call after each step of a part."""
        started, done = time.monotonic(), 0
        self._progress(part, 0, total, 0.0)

        def step() -> None:
            nonlocal done
            done += 1
            self._progress(part, done, total, time.monotonic() - started)

        return step

    def follow(self, part: str) -> Callable[[int, int], None]:
        """The same for work that counts itself."""
        started = time.monotonic()
        return lambda done, total: self._progress(part, done, total, time.monotonic() - started)


def digest(content: str | bytes) -> str:
    """SHA-256 in hex."""
    return hashlib.sha256(content.encode() if isinstance(content, str) else content).hexdigest()
