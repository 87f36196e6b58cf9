"""Files that are compiled from others and shipped beside them, because compiling would delay every command.

The first line of a compiled file has the hash of its source. When it does not match, the file is not used, so an edited source
takes effect at once.
"""

from __future__ import annotations

import hashlib
from pathlib import Path


def compiled_lines(source: Path, compiled: Path) -> list[str] | None:
    """Return the lines of a compiled file without its heading, None if it does not belong to its source as it is now."""
    head, _, text = compiled.read_text(encoding="utf-8").partition("\n")
    return text.splitlines() if head == heading(source) else None


def heading(source: Path) -> str:
    """Return the first line of what is compiled from a source."""
    return f"# Generated from {source.name}; sha256 {hashlib.sha256(source.read_bytes()).hexdigest()}"
