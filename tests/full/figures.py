"""Figures derived from logs and reports without the code that reports are made by."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean


def kappa(rated: Sequence[tuple[str, str]]) -> float:
    """Cohen's, from its definition."""
    observed = fmean(one == two for one, two in rated)
    first, second = (Counter(pair[side] for pair in rated) for side in (0, 1))
    chance = sum(first[label] * second[label] for label in first) / len(rated) ** 2
    return (observed - chance) / (1 - chance)


@dataclass(frozen=True)
class Marks:
    """What a log says of one run, read by the engine's own reader."""

    category: str
    checks: str
    mode: str | None
    judge: tuple[str, ...]
    judge_mode: str | None


def marks(path: Path) -> list[Marks]:
    from inspect_ai.log import read_eval_log

    rows = []
    for sample in read_eval_log(str(path)).samples or ():
        scores = [score for score in (sample.scores or {}).values() if score.metadata]
        (checks,) = [score.metadata for score in scores if score.metadata and "headline" in score.metadata]
        said = [score for score in scores if score.metadata and "judgement" in score.metadata]
        verdicts = tuple({"C": "correct", "I": "incorrect"}[str(score.value)] for score in said)
        judge_mode = (said[0].metadata or {})["error_mode"] if said else None
        rows.append(Marks(sample.metadata["category"], checks["headline"], checks["error_mode"], verdicts, judge_mode))
    return rows


def by_category(rows: Sequence[Marks], right: Sequence[bool]) -> dict[str, float]:
    names = dict.fromkeys(row.category for row in rows)
    return {name: fmean(ok for row, ok in zip(rows, right, strict=True) if row.category == name) for name in names}


def by_run(path: Path) -> dict[str, dict[str, str]]:
    """The rows of a table of the report by the name of the run."""
    with path.open(newline="", encoding="utf-8") as file:
        return {row["run"]: row for row in csv.DictReader(file) if "run" in row}
