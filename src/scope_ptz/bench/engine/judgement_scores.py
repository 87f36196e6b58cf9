"""Where judgements stand in a log: each a score of its own, named after the judge and the number of its judgement."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from inspect_ai.scorer import CORRECT, INCORRECT, Score
from pydantic import ValidationError

from scope_ptz.bench.scoring.trials import Judgement
from scope_ptz.errors import TraceError

JUDGE = "judge"
JUDGEMENT = "judgement"


def score_of_judgement(judgement: Judgement) -> Score:
    """A judgement as a score of the engine. One without a verdict has no value, and no metric counts it."""
    metadata = {"error_mode": judgement.error_mode, JUDGEMENT: judgement.model_dump(mode="json")}
    if judgement.verdict in ("correct", "incorrect"):
        value = CORRECT if judgement.verdict == "correct" else INCORRECT
        return Score(value=value, explanation=judgement.reason, metadata=metadata)
    return Score.unscored(reason=judgement.verdict, explanation=judgement.reason, metadata=metadata)


def judgements_in(scores: Mapping[str, Any]) -> tuple[Judgement, ...]:
    """The judgements among the scores of a sample, in the order in which they were made; of two with one number, which a failed
    one has that was asked for again, the newer. Raises ``TraceError``."""
    told = (score["metadata"][JUDGEMENT] for score in scores.values() if JUDGEMENT in (score.get("metadata") or {}))
    try:
        made = [Judgement.model_validate(row) for row in told]
        return tuple({(j.judge, j.prompt, j.repeat): j for j in made}.values())
    except ValidationError as error:
        raise TraceError(f"A judgement in the log is damaged: {error.errors(include_url=False)[0]['msg']}.") from error
