"""The schema and the strict parser of a judge's reply. The parser never guesses: an invalid reply is reported to the judge."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from scope_ptz.bench.scoring.error_modes import ErrorMode

NO_MODE = "none"
MAX_REASON_CHARS = 1_000
_MAX_FAILED_BRACES = 100
"""Maximum number of opening braces without valid JSON after which the parser stops."""

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
"""The reason comes first, so that a model without a reasoning phase states it before it decides."""


class JudgeReply(BaseModel):
    """A valid verdict. It has an error mode if and only if it is "incorrect". Further fields are ignored."""

    model_config = ConfigDict(frozen=True, extra="ignore")

    verdict: Literal["correct", "incorrect"]
    error_mode: ErrorMode | None
    reason: str = Field(min_length=1)

    @field_validator("verdict", "error_mode", mode="before")
    @classmethod
    def _plain(cls, value: Any) -> Any:
        return value.strip().lower() if isinstance(value, str) else value

    @field_validator("error_mode", mode="before")
    @classmethod
    def _none(cls, value: Any) -> Any:
        return None if isinstance(value, str) and value.strip().lower() == NO_MODE else value

    @field_validator("reason", mode="after")
    @classmethod
    def _short(cls, reason: str) -> str:
        line = " ".join(reason.split())
        if not line:
            raise ValueError("it is blank")
        return line if len(line) <= MAX_REASON_CHARS else line[: MAX_REASON_CHARS - 1] + "…"

    @model_validator(mode="after")
    def _consistent(self) -> JudgeReply:
        if self.verdict == "correct" and self.error_mode is not None:
            raise ValueError(f'a correct run has no error mode: "error_mode" must be "{NO_MODE}", or the verdict "incorrect"')
        if self.verdict == "incorrect" and self.error_mode is None:
            raise ValueError("an incorrect run has exactly one error mode")
        return self


def parse_judge_reply(text: str) -> JudgeReply | str:
    """Parse the verdict in a judge's reply.

    The reply must contain one JSON object, possibly surrounded by words or a code fence. Several objects must agree.

    Returns:
        The verdict, or a description of the error, which is sent to the judge.
    """
    found = [content for content in _objects(text) if isinstance(content, dict) and "verdict" in content]
    if not found:
        return "there is no JSON object with a verdict in it" if text.strip() else "it is empty"
    replies = list[JudgeReply]()
    for content in found:
        try:
            replies.append(JudgeReply.model_validate(content))
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            where = ".".join(str(part) for part in first["loc"])
            return f"{where}: {first['msg']}" if where else first["msg"]
    if len({(reply.verdict, reply.error_mode) for reply in replies}) > 1:
        return "it holds several different verdicts"
    return replies[-1]


def _objects(text: str) -> Iterator[Any]:
    """Yield every JSON object in a text that is not inside another one. Objects with repeated names are invalid."""
    decoder, at, failed = json.JSONDecoder(object_pairs_hook=_once), text.find("{"), 0
    while at != -1 and failed < _MAX_FAILED_BRACES:
        try:
            content, end = decoder.raw_decode(text, at)
        except (ValueError, RecursionError):
            at, failed = text.find("{", at + 1), failed + 1
            continue
        yield content
        at = text.find("{", end)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    names = [name for name, _ in pairs]
    if len(set(names)) < len(names):
        raise ValueError("a name is given twice")
    return dict(pairs)
