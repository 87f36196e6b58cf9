"""Find the tool steps in a cell of an imported table, and arguments that do not belong to any step."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from scope_ptz.taskgen.importing.paper_names import TOOLS, normalise

_TOOL_KEYS = ("tool", "name", "tool_name", "function")


def cell_excerpt(value: Any) -> str:
    """Return part of a cell as JSON text for a finding, truncated to 120 characters."""
    return json.dumps(value, ensure_ascii=False, default=str)[:120]


def find_steps(content: Any, note: Callable[[str], None]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the tools in a cell, each with its arguments. Lists and objects may be nested.

    Args:
        content: The parsed content of the cell.
        note: Called with a line of text for every part that names no tool.
    """
    if isinstance(content, str):
        yield content, {}
    elif isinstance(content, dict):
        name = next((content[key] for key in _TOOL_KEYS if isinstance(content.get(key), str)), None)
        if name is not None:
            arguments: Mapping[str, Any] = next(
                (content[key] for key in ("args", "arguments", "parameters") if isinstance(content.get(key), dict)), {}
            )
            yield name, arguments
        elif any(key in content for key in _TOOL_KEYS):
            note(f"{cell_excerpt(content)} names no tool")
        else:
            for key, value in content.items():
                if normalise(key) in TOOLS:
                    yield key, value if isinstance(value, dict) else {}
                else:
                    yield from find_steps(value, note)
    elif isinstance(content, list):
        for step in content:
            if step is None:
                note("null names no tool")
            yield from find_steps(step, note)
    elif content is not None:
        note(f"{cell_excerpt(content)} names no tool")


def find_unused_arguments(given: Any, names: Sequence[str]) -> Iterator[str]:
    """Yield a line of text for every argument that does not belong to an expected call.

    Arguments can be grouped by the name or the number of a call. Ungrouped arguments belong to the first call; if any of their
    values is a list or an object, they are accepted only if a single call is expected.
    """
    if given in (None, "", [], {}):
        return
    if not names:
        yield f"{cell_excerpt(given)}: the row expects no call that could have arguments"
    elif isinstance(given, list):
        for index, arguments in enumerate(given):
            if arguments is not None and (index >= len(names) or not isinstance(arguments, dict)):
                yield f"{cell_excerpt(arguments)} (number {index + 1}) does not match an expected call"
    elif not isinstance(given, dict):
        yield f"{cell_excerpt(given)} is not a set of arguments"
    elif any(isinstance(value, dict | list) for value in given.values()) and not is_single_call(given, names):
        for name, value in given.items():
            yield from _find_unused_of(name, value, names)


def is_single_call(given: dict[str, Any], names: Sequence[str]) -> bool:
    """Return whether these are the arguments of a single call, rather than arguments grouped by call name or number."""
    return len(names) == 1 and not any(name in names or name == "0" or normalise(name) in TOOLS for name in given)


def _find_unused_of(name: str, value: Any, names: Sequence[str]) -> Iterator[str]:
    numbered = name.isdecimal() and int(name) < len(names)
    if name not in names and not numbered:
        yield f"{name}: {cell_excerpt(value)} does not match an expected call"
    elif isinstance(value, list):
        for index, arguments in enumerate(value):
            if arguments is not None and (index >= max(names.count(name), 1) or not isinstance(arguments, dict)):
                yield f"{name}: {cell_excerpt(arguments)} (number {index + 1}) does not match an expected call"
    elif not isinstance(value, dict) and value not in (None, ""):
        yield f"{name}: {cell_excerpt(value)} is not a set of arguments"
