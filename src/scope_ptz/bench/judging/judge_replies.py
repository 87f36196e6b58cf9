"""The JSON schema for judge replies, and a strict parser.

If a reply is invalid, the parser returns an error message, which is sent back to the judge.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from scope_ptz.bench.scoring.error_modes import ErrorMode

NO_MODE = "none"
"""Value of ``error_mode`` in the reply for a correct run."""
MAX_REASON_CHARS = 1_000
"""Maximum length of a reason in characters. Longer reasons are truncated."""
_MAX_FAILED_BRACES = 100
"""Number of opening braces without a valid JSON object after which the parser gives up."""

REPLY_SCHEMA: dict[str, Any] = {
    "type": "object",
    "properties": {
        "reason": {"type": "string"},
        "verdict": {"type": "string", "enum": ["correct", "incorrect"]},
        "error_mode": {"type": "string", "enum": [*(mode.value for mode in ErrorMode), NO_MODE]},
    },
    "required": ["reason", "verdict", "error_mode"],
    "additionalProperties": False,
}
"""Schema of a reply. The reason comes first, so that a model without a reasoning phase states it before the verdict."""


class JudgeReply(BaseModel):
    """A valid reply. It has an error mode if and only if the verdict is "incorrect". Additional fields are ignored."""

    model_config = ConfigDict(frozen=True, extra="ignore")

    verdict: Literal["correct", "incorrect"]
    error_mode: ErrorMode | None
    reason: str = Field(min_length=1)

    @field_validator("verdict", "error_mode", mode="before")
    @classmethod
    def _normalize(cls, value: Any) -> Any:
        return value.strip().lower() if isinstance(value, str) else value

    @field_validator("error_mode", mode="before")
    @classmethod
    def _none_mode(cls, value: Any) -> Any:
        return None if isinstance(value, str) and value.strip().lower() == NO_MODE else value

    @field_validator("reason", mode="after")
    @classmethod
    def _shorten(cls, reason: str) -> str:
        line = " ".join(reason.split())
        if not line:
            raise ValueError("it is blank")
        return line if len(line) <= MAX_REASON_CHARS else line[: MAX_REASON_CHARS - 1] + "…"

    @model_validator(mode="after")
    def _check_mode(self) -> JudgeReply:
        if self.verdict == "correct" and self.error_mode is not None:
            raise ValueError(f'a correct run has no error mode: "error_mode" must be "{NO_MODE}", or the verdict "incorrect"')
        if self.verdict == "incorrect" and self.error_mode is None:
            raise ValueError("an incorrect run has exactly one error mode")
        return self


def parse_judge_reply(text: str) -> JudgeReply | str:
    """Parse a judge's reply.

    The reply must contain a JSON object with a verdict, possibly surrounded by other text or a code fence. If it contains several
    such objects, they must agree.

    Returns:
        The parsed reply, or an error message to send back to the judge.
    """
    objects = [content for content in _json_objects(text) if isinstance(content, dict) and "verdict" in content]
    if not objects:
        return "there is no JSON object with a verdict in it" if text.strip() else "it is empty"
    replies = list[JudgeReply]()
    for content in objects:
        try:
            replies.append(JudgeReply.model_validate(content))
        except ValidationError as error:
            first_error = error.errors(include_url=False, include_input=False)[0]
            field = ".".join(str(part) for part in first_error["loc"])
            return f"{field}: {first_error['msg']}" if field else first_error["msg"]
    if len({(reply.verdict, reply.error_mode) for reply in replies}) > 1:
        return "it holds several different verdicts"
    return replies[-1]


def _json_objects(text: str) -> Iterator[Any]:
    """Yield every top-level JSON object in ``text``. Objects with duplicate names are invalid."""
    decoder, start, failed = json.JSONDecoder(object_pairs_hook=_object_with_unique_names), text.find("{"), 0
    while start != -1 and failed < _MAX_FAILED_BRACES:
        try:
            content, end = decoder.raw_decode(text, start)
        except (ValueError, RecursionError):
            start, failed = text.find("{", start + 1), failed + 1
            continue
        yield content
        start = text.find("{", end)


def _object_with_unique_names(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    names = [name for name, _ in pairs]
    if len(set(names)) < len(names):
        raise ValueError("a name is given twice")
    return dict(pairs)
