"""Read and write a stored copy of the tool schemas, for commands that only print them.

``scope_ptz.tools.registry`` generates the schemas from pydantic models, but importing the models takes longer than reading
``data/tools.json``. A test compares the two. After changing a tool, run ``write_stored_schemas()`` to update the copy.
"""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any


def stored_schemas() -> list[dict[str, Any]]:
    """Return the stored schemas, which equal those from ``ToolRegistry.schemas``."""
    schemas: list[dict[str, Any]] = json.loads(_path().read_bytes())
    return schemas


def write_stored_schemas() -> None:
    """Write the current schemas to the stored copy."""
    from scope_ptz.tools.registry import schemas

    _path().write_text(json.dumps(schemas(), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def _path() -> Path:
    return Path(str(files("scope_ptz"))) / "data" / "tools.json"
