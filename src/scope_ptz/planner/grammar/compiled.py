"""Read the compiled vocabulary and grammar. They are stored next to their sources, because compiling would delay every command.

The first line of a compiled file contains the hash of its source. If the hash does not match, the compiled file is ignored, so that
changes to the source take effect immediately.
"""

from __future__ import annotations

import hashlib
from pathlib import Path


def compiled_lines(source: Path, compiled: Path) -> list[str] | None:
    """Return the lines of a compiled file without its heading; None if the file is out of date."""
    head, _, text = compiled.read_text(encoding="utf-8").partition("\n")
    return text.splitlines() if head == heading(source) else None


def heading(source: Path) -> str:
    """Return the first line of the file that is compiled from a source. It contains the hash of the source."""
    return f"# Generated from {source.name}; sha256 {hashlib.sha256(source.read_bytes()).hexdigest()}"
