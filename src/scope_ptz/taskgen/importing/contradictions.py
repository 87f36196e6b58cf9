"""Find fields in a row that contradict each other, such as a tool for the full view with an argument for the current one."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from scope_ptz.bench.tasks.task import RequiredCall, Scope, ToolName
from scope_ptz.taskgen.importing.paper_names import (
    DURATION_ARGUMENTS,
    TEXT_ARGUMENTS,
    VIEW_ARGUMENTS,
    category_of,
    normalise,
    scope_of,
)

_FULL_VIEW = re.compile(
    r"\b(?:full|whole|entire) (?:panorama|panoramic (?:view|scene)|scene|view|360|surroundings)|\bpanorama\b"
    r"|\b360[ -]?(?:deg\w*|°|view)"
    r"|\b(?:sweep|pan across) the (?:whole |entire |full )?scene\b|\beverywhere in the scene\b",
    re.IGNORECASE,
)
_CURRENT_VIEW = re.compile(r"\b(?:current|present) (?:view|frame|image)\b|\bwithout moving the camera\b", re.IGNORECASE)
_PRESET = re.compile(r"\bpreset[\s:'\"“]+([\w-]+(?: \d+)?)", re.IGNORECASE)
_STEP_CATEGORIES = frozenset({"single_call", "multi_step_command", "multi_step_reasoning"})
"""Categories that state the number of steps. All other categories are question types."""
_SINGLE_STEP = frozenset({"single", "single_step", "single_call"})


def argument_contradictions(tool: ToolName, tools_cell: Mapping[str, Any], arguments_cell: Mapping[str, Any]) -> Iterator[str]:
    """Yield a sentence for each argument of a call that the row gives twice, with different values.

    Args:
        tool: The tool.
        tools_cell: The arguments in the cell with the expected tools.
        arguments_cell: The arguments in the cell with the arguments.
    """
    order, arguments = _group_by_meaning(tool, tools_cell), _group_by_meaning(tool, arguments_cell)
    for content, source in ((order, "the expected tools"), (arguments, "the arguments")):
        for name, values in content.items():
            if name in ("view", "duration") and len({_comparison_key(name, value) for value in values}) > 1:
                yield f"{tool}: {source} give {name} as {_list_values(values)}"
    for name in sorted(order.keys() & arguments.keys()):
        if {_comparison_key(name, value) for value in order[name]}.isdisjoint(
            _comparison_key(name, value) for value in arguments[name]
        ):
            in_tools, in_cell = _list_values(order[name]), _list_values(arguments[name])
            yield f"{tool}: the expected tools say {name} {in_tools}, the arguments say {in_cell}"


def field_contradictions(cells: Mapping[str, str], calls: Sequence[RequiredCall], presets: Collection[str]) -> Iterator[str]:
    """Yield a sentence for each pair of fields in a row that contradict each other.

    Args:
        cells: The cells of the row.
        calls: The expected calls.
        presets: Names of the scene's presets.
    """
    question = cells.get("question", "")
    views = {str(call.arguments["view"].equals) for call in calls if "view" in call.arguments}
    answer_view = scope_of(cells.get("answer_view", ""))
    if answer_view is not None and views and answer_view not in views:
        yield f"answer_view says {answer_view}, the arguments of the expected calls say {' and '.join(sorted(views))}"
    question_view = _view_in_question(question)
    if question_view is not None and views and question_view not in views:
        listed_views = " and ".join(sorted(views))
        yield f"the question asks for the {question_view} view, the arguments of the expected calls say {listed_views}"
    elif question_view == "full" and answer_view == "current":
        yield "the question asks for the full view, answer_view says current"
    columns = ("eval_category", "category", "question_type")
    categories = {column: found for column in columns if (found := category_of(cells.get(column, ""))) is not None}
    # A question of any type, such as counting, can take one step or several.
    states_step_count = {category in _STEP_CATEGORIES for category in categories.values()}
    if len(set(categories.values())) > 1 and len(states_step_count) == 1:
        yield "; ".join(f"{column} says {category}" for column, category in categories.items())
    if normalise(cells.get("multi_step_mode", "")) in _SINGLE_STEP and len(calls) > 1:
        yield f"multi_step_mode says {cells['multi_step_mode']}, but {len(calls)} calls are expected"
    yield from _preset_contradictions(question, calls, presets)


def _preset_contradictions(question: str, calls: Sequence[RequiredCall], presets: Collection[str]) -> Iterator[str]:
    by_name = {normalise(preset): preset for preset in presets}
    named = {by_name[normalise(name)] for name in _PRESET.findall(question) if normalise(name) in by_name}
    expected = {str(call.arguments["name"].equals) for call in calls if call.tool == "go_to_preset" and "name" in call.arguments}
    if named and expected and named.isdisjoint(expected):
        yield f"the question names the preset {' and '.join(sorted(named))}, the arguments say {' and '.join(sorted(expected))}"


def _view_in_question(question: str) -> Scope | None:
    """Return the view that a question requests explicitly; None if it requests none or both."""
    full, current = bool(_FULL_VIEW.search(question)), bool(_CURRENT_VIEW.search(question))
    return None if full == current else "full" if full else "current"


def _group_by_meaning(tool: ToolName, given: Mapping[str, Any]) -> dict[str, list[Any]]:
    """Group the values of arguments by meaning. Several argument names can have the same meaning."""
    found: dict[str, list[Any]] = {}
    for name, value in given.items():
        if value is not None and value != "":
            found.setdefault(_meaning(tool, normalise(name)), []).append(value)
    return found


def _meaning(tool: ToolName, name: str) -> str:
    if name in VIEW_ARGUMENTS:
        return "view"
    if name in DURATION_ARGUMENTS:
        return "duration"
    # A question may be given together with the object that it is about, so the texts of query_answer are not compared.
    return "text" if name in TEXT_ARGUMENTS.get(tool, ()) and tool != "query_answer" else name


def _comparison_key(name: str, value: Any) -> str:
    """Return a key that is equal for equivalent values."""
    if name == "view":
        return scope_of(str(value)) or normalise(str(value))
    try:
        return f"{float(str(value).strip().rstrip('°%x')):g}"
    except ValueError:
        return normalise(str(value))


def _list_values(values: Sequence[Any]) -> str:
    return " and ".join(repr(value)[:60] for value in values)
