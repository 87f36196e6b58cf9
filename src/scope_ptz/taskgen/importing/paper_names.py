"""Map the names of tools, arguments, categories and modes in the paper's files to SCOPE's names."""

from __future__ import annotations

import re
from typing import Literal

from scope_ptz.bench.tasks.imported import Policy
from scope_ptz.bench.tasks.task import Category, Scope, ToolName

TOOLS: dict[str, ToolName] = {
    "ptz_adjust": "adjust_ptz",
    "adjust_ptz": "adjust_ptz",
    "go_to_preset": "go_to_preset",
    "home_action": "go_home",
    "go_home": "go_home",
    "get_presets": "get_presets",
    "take_image": "take_image",
    "count_pointing": "count_objects",
    "count_objects": "count_objects",
    "query_answer": "query_answer",
    "zoom_bounding": "zoom_to_object",
    "zoom_to_object": "zoom_to_object",
    "track_object": "track_object",
}
_OBJECT_ARGUMENTS = ("object_of_interest", "description", "instruction", "object", "name")
TEXT_ARGUMENTS: dict[ToolName, tuple[str, ...]] = {
    "go_to_preset": ("name", "preset", "preset_name"),
    "count_objects": _OBJECT_ARGUMENTS,
    "zoom_to_object": _OBJECT_ARGUMENTS,
    "track_object": _OBJECT_ARGUMENTS,
    "query_answer": ("instruction", "question", "object_of_interest", "query"),
}
"""Arguments that may contain the text of a tool call, in order of preference."""

VIEW_ARGUMENTS = ("view_type", "view", "answer_view")
DURATION_ARGUMENTS = ("duration", "duration_s", "seconds")
ZOOM_IN = frozenset({"in", "max", "full_in", "tele", "maximum", "1"})
ZOOM_OUT = frozenset({"out", "min", "full_out", "wide", "minimum", "-1"})

_CATEGORIES: dict[Category, tuple[str, ...]] = {
    "counting": ("counting", "count", "object_counting", "counts"),
    "descriptor": ("descriptor", "descriptors", "description", "describe", "descriptive", "attribute", "attributes"),
    "location": ("location", "spatial", "location_spatial", "spatial_location", "spatial_reasoning"),
    "ocr": ("ocr", "ocr_identification", "text", "text_identification", "reading"),
    "single_call": ("single_call", "single", "single_step", "single_tool_call", "single_command", "single_step_command"),
    "multi_step_command": ("multi_step_command", "multi_command", "command", "multi_step_commands", "multistep_command"),
    "multi_step_reasoning": ("multi_step_reasoning", "multi_reasoning", "multistep_reasoning", "reasoning"),
    "comparative": ("comparative", "comparative_relational", "comparison", "relational", "comparative_reasoning"),
}
_BY_SPELLING = {spelling: category for category, spellings in _CATEGORIES.items() for spelling in spellings}

_POLICIES: dict[Policy, tuple[str, ...]] = {
    "all": (
        "",
        "all",
        "all_required",
        "required",
        "must",
        "must_include",
        "at_least",
        "superset",
        "contains",
        "include",
        "default",
    ),
    "exact": ("exact", "exactly", "only", "strict", "exact_match", "equal"),
    "any": ("any", "any_of", "one_of", "at_least_one", "either"),
    "none": ("none", "optional", "ignore", "off", "no", "false", "not_required"),
}
_ORDERED = ("ordered", "strict", "sequence", "sequential", "in_order", "strict_order", "order", "fixed", "true", "yes", "1")
_UNORDERED = ("unordered", "any", "any_order", "free", "none", "no_order", "flexible", "set", "false", "no", "0", "")
_SINGLE = ("single", "single_step", "single_call", "n_a", "na")
_NO_CHECK = ("none", "off", "ignore", "no", "false", "0", "skip", "tools_only", "names_only")
_CHECK = (
    "",
    "exact",
    "strict",
    "loose",
    "lenient",
    "tolerant",
    "fuzzy",
    "subset",
    "contains",
    "required",
    "yes",
    "true",
    "1",
    "on",
    "all",
)
_FULL = (
    "full",
    "full_scene",
    "full_view",
    "360",
    "panorama",
    "panoramic",
    "scene",
    "all",
    "whole",
    "whole_scene",
    "sweep",
    "fullscene",
)
_CURRENT = ("current", "current_view", "view", "now", "present", "local", "currentview", "single", "preset", "start")


def normalise(text: str) -> str:
    """Return a name in lower case, with each run of characters other than letters and digits replaced by one underscore."""
    return re.sub(r"[^a-z0-9]+", "_", text.strip().lower()).strip("_")


def category_of(text: str) -> Category | None:
    """Return the category for one of its spellings; None for an unknown name."""
    return _BY_SPELLING.get(re.sub(r"^multistep", "multi_step", normalise(text)))


def scope_of(text: str) -> Scope | None:
    """Return the scope for one of its spellings; None for an unknown name."""
    name = normalise(text)
    return "full" if name in _FULL else "current" if name in _CURRENT else None


def policy_of(text: str) -> Policy | None:
    """Return the policy for required tools; None for an unknown word."""
    return next((policy for policy, words in _POLICIES.items() if normalise(text) in words), None)


def order_of(text: str) -> Literal["ordered", "any"] | None:
    """Return "ordered" if the order of calls matters, "any" if it does not (as for a single step), and None for an unknown word."""
    name = normalise(text)
    return "ordered" if name in _ORDERED else "any" if name in _UNORDERED or name in _SINGLE else None


def compares_arguments(text: str) -> bool | None:
    """Return whether a run's arguments must match the expected ones; None for an unknown word."""
    name = normalise(text)
    return False if name in _NO_CHECK else True if name in _CHECK else None
