"""The format in which a model writes drafts. Drafts are data, never code, and are validated before use.

A draft contains the moves to one or more views, the name of the program that computes the answer from the ground truth, and the
answer that the model expects, which is compared with the computed one. Class names and docstrings are part of the schema that the
model receives.
"""

from __future__ import annotations

import json
import re
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from scope_ptz.bench.tasks.task import Category

Program = Literal["count", "exists", "colour", "text", "side", "most", "sum", "action"]
ALLOWED_PROGRAMS: dict[Category, tuple[Program, ...]] = {
    "counting": ("count",),
    "descriptor": ("colour", "exists"),
    "location": ("side", "exists"),
    "ocr": ("text",),
    "single_call": ("action",),
    "multi_step_command": ("action",),
    "multi_step_reasoning": ("sum", "most"),
    "comparative": ("most",),
}
"""The programs allowed for tasks in each category."""

MAX_DRAFTS, MAX_REPLY_CHARS = 20, 200_000  # maximum number of drafts and of characters in one reply
Word = Annotated[str, Field(min_length=1, max_length=60, pattern=r"^[\w][\w '/&-]*$")]
_FENCE = re.compile(r"\A\s*```(?:json)?\s*(.*?)\s*```\s*\Z", re.DOTALL)


class _StrictModel(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class Move(_StrictModel):
    """Going to a preset, or turning and zooming; not both."""

    preset: Word | None = None
    pan_deg: Annotated[float, Field(ge=-179, le=179, allow_inf_nan=False)] = 0.0
    tilt_deg: Annotated[float, Field(ge=-60, le=60, allow_inf_nan=False)] = 0.0
    zoom_factor: Annotated[float, Field(gt=0.19, le=5, allow_inf_nan=False)] | None = None

    @property
    def turns(self) -> bool:
        """Whether the move turns or zooms."""
        return bool(self.pan_deg or self.tilt_deg or self.zoom_factor)


class DraftView(_StrictModel):
    """A view: the moves that lead there from the one before, and whether everything around it is meant."""

    moves: Annotated[list[Move], Field(max_length=4)] = []
    sweep: bool = False


class Thing(_StrictModel):
    """A kind of thing, as the inventory has it."""

    category: Word
    colour: Word | None = None


class Draft(_StrictModel):
    """A task as a model drafts it. ``things``: one, or for "most" in a single view those to compare."""

    instruction: Annotated[str, Field(min_length=8, max_length=400)]
    category: Category
    start: Word
    views: Annotated[list[DraftView], Field(min_length=1, max_length=3)]
    program: Program
    things: Annotated[list[Thing], Field(max_length=3)] = []
    axis: Literal["across", "down"] | None = None
    expected: Annotated[str, Field(max_length=200)]

    @field_validator("instruction", "expected")
    @classmethod
    def _check_printable(cls, text: str) -> str:
        if not text.isprintable():
            raise ValueError("holds characters that cannot be printed")
        return text.strip()


def reply_schema() -> dict[str, Any]:
    """Return the JSON schema of a reply: a list of drafts."""
    return {
        "type": "object",
        "properties": {"drafts": {"type": "array", "items": {"$ref": "#/$defs/Draft"}, "maxItems": MAX_DRAFTS}},
        "required": ["drafts"],
        "additionalProperties": False,
        "$defs": {**Draft.model_json_schema().get("$defs", {}), "Draft": _inline_defs(Draft.model_json_schema())},
    }


def _inline_defs(schema: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in schema.items() if name != "$defs"}


def parse_reply(text: str) -> list[Any]:
    """Return the drafts in a reply as JSON data, without validating them. Drafts beyond ``MAX_DRAFTS`` are omitted.

    Raises:
        ValueError: The reply is not a list of drafts.
    """
    if len(text) > MAX_REPLY_CHARS:
        raise ValueError(f"the reply is longer than {MAX_REPLY_CHARS} characters")
    fenced_block = _FENCE.match(text)
    try:
        content = json.loads(fenced_block.group(1) if fenced_block else text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"the reply is not JSON: {error}") from error
    rows = content.get("drafts") if isinstance(content, dict) else content
    if not isinstance(rows, list):
        raise ValueError("the reply has no list of drafts")  # noqa: TRY004 - a wrong value in a reply is not a TypeError
    return rows[:MAX_DRAFTS]


def parse_draft(row: Any) -> Draft | str:
    """Return a draft, or the reason why it is not valid."""
    try:
        return Draft.model_validate_json(json.dumps(row))
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        return f"{'.'.join(str(part)[:40] for part in first['loc']) or 'draft'}: {first['msg']}"
    except (TypeError, ValueError, RecursionError) as error:
        return f"draft: {error}"
