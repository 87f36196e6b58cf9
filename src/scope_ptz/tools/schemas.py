"""The shipped copy of the tools' schemas, for those who only print them.

The schemas belong to ``scope_ptz.tools.registry``, which makes them from pydantic models. Importing the models takes longer than
reading ``data/tools.json``. A test compares both; ``renew()`` rewrites the copy after a tool was changed.
"""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any


def shipped_schemas() -> list[dict[str, Any]]:
    """Return all tools in the OpenAI function format, as ``ToolRegistry.schemas`` does."""
    schemas: list[dict[str, Any]] = json.loads(_path().read_bytes())
    return schemas


def renew() -> None:
    """Rewrite the shipped copy."""
    from scope_ptz.tools.registry import schemas

    _path().write_text(json.dumps(schemas(), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def _path() -> Path:
    return Path(str(files("scope_ptz"))) / "data" / "tools.json"
