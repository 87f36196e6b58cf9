"""Convert judgements to Inspect scores and back. Each judgement is stored as a separate score of the sample."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from inspect_ai.scorer import CORRECT, INCORRECT, Score
from pydantic import ValidationError

from scope_ptz.bench.scoring.trials import Judgement
from scope_ptz.errors import TraceError

JUDGE = "judge"
"""Name of the scorer in logs."""
JUDGEMENT = "judgement"
"""Key for the judgement in a score's metadata."""


def score_of_judgement(judgement: Judgement) -> Score:
    """Convert a judgement to an Inspect score. A judgement without a verdict is unscored, so metrics ignore it."""
    metadata = {"error_mode": judgement.error_mode, JUDGEMENT: judgement.model_dump(mode="json")}
    if judgement.verdict in ("correct", "incorrect"):
        value = CORRECT if judgement.verdict == "correct" else INCORRECT
        return Score(value=value, explanation=judgement.reason, metadata=metadata)
    return Score.unscored(reason=judgement.verdict, explanation=judgement.reason, metadata=metadata)


def judgements_in(scores: Mapping[str, Any]) -> tuple[Judgement, ...]:
    """Return the judgements among the scores of a sample, in the order in which they were made.

    If a failed judgement was retried, only the retry is returned. Both have the same index.

    Raises:
        TraceError: A judgement is damaged.
    """
    stored = (score["metadata"][JUDGEMENT] for score in scores.values() if JUDGEMENT in (score.get("metadata") or {}))
    try:
        judgements = [Judgement.model_validate(row) for row in stored]
        return tuple({(j.judge, j.prompt, j.repeat): j for j in judgements}.values())
    except ValidationError as error:
        raise TraceError(f"A judgement in the log is damaged: {error.errors(include_url=False)[0]['msg']}.") from error
