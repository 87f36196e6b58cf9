"""Figures computed from logs and reports, independently of the code of reports."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean


def kappa(ratings: Sequence[tuple[str, str]]) -> float:
    """Return Cohen's kappa, computed from its definition."""
    observed = fmean(one == two for one, two in ratings)
    first, second = (Counter(pair[side] for pair in ratings) for side in (0, 1))
    chance = sum(first[label] * second[label] for label in first) / len(ratings) ** 2
    return (observed - chance) / (1 - chance)


@dataclass(frozen=True)
class RunScores:
    """The scores of one run in a log, read with the engine's own reader."""

    category: str
    checks: str
    mode: str | None
    judge: tuple[str, ...]
    judge_mode: str | None


def read_scores(path: Path) -> list[RunScores]:
    from inspect_ai.log import read_eval_log

    rows = []
    for sample in read_eval_log(str(path)).samples or ():
        scores = [score for score in (sample.scores or {}).values() if score.metadata]
        (checks,) = [score.metadata for score in scores if score.metadata and "headline" in score.metadata]
        judgements = [score for score in scores if score.metadata and "judgement" in score.metadata]
        verdicts = tuple({"C": "correct", "I": "incorrect"}[str(score.value)] for score in judgements)
        judge_mode = (judgements[0].metadata or {})["error_mode"] if judgements else None
        rows.append(RunScores(sample.metadata["category"], checks["headline"], checks["error_mode"], verdicts, judge_mode))
    return rows


def by_category(rows: Sequence[RunScores], correct: Sequence[bool]) -> dict[str, float]:
    names = dict.fromkeys(row.category for row in rows)
    return {name: fmean(ok for row, ok in zip(rows, correct, strict=True) if row.category == name) for name in names}


def by_run(path: Path) -> dict[str, dict[str, str]]:
    """Return the rows of a CSV table of the report, by run."""
    with path.open(newline="", encoding="utf-8") as file:
        return {row["run"]: row for row in csv.DictReader(file) if "run" in row}
