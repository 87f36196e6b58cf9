"""Measure the accuracy of LLM judges on runs with known faults: false accepts, false rejects, and reported error modes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

import anyio
from pydantic import BaseModel, ConfigDict, ValidationError

from scope_ptz.bench.judging.agreement import RatedRun, Rater, add_rating, judgements_with_raters
from scope_ptz.bench.judging.case import JudgeCase, case_of_episode
from scope_ptz.bench.judging.json_lines import complete_lines
from scope_ptz.bench.judging.judge import Judge
from scope_ptz.bench.judging.kappa import KappaResult, cohen_agreement
from scope_ptz.bench.scoring.episode import Episode, PresetViewpoints
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Judgement
from scope_ptz.bench.tasks.task import Task
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.errors import InputError
from scope_ptz.taskgen.gold.mutations import GoldRun

PASSES = "passes"  # used instead of an error mode for runs without a fault
WITHOUT_VERDICT = ("unparseable", "failed")  # outcomes of judgements without a verdict


class GoldCase(BaseModel):
    """A run with a known verdict, as a case for a judge.

    Attributes:
        facts: The task, as the judge receives it.
        case: The run, as the judge receives it.
        fault: Error mode of the fault; None for a passing run.
        source: Name of the fault function, or "reference" for a passing run.
    """

    model_config = ConfigDict(frozen=True, arbitrary_types_allowed=True)

    facts: TaskFacts
    case: JudgeCase
    fault: ErrorMode | None
    source: str

    @property
    def key(self) -> str:
        """A key that identifies the run among all gold runs."""
        return f"{self.facts.id}/{self.fault.value if self.fault else PASSES}/{self.source}"


class GoldVerdict(BaseModel):
    """A stored judgement of a gold run."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    key: str
    task: str
    fault: ErrorMode | None
    judgement: Judgement


def gold_case(gold: GoldRun, preset_viewpoints: PresetViewpoints) -> GoldCase:
    """Return a gold run as a case for a judge. ``preset_viewpoints`` are those of its scene."""
    return _create_case(gold.task, gold.episode, preset_viewpoints, gold.mode, gold.fault)


def passing_case(task: Task, episode: Episode, preset_viewpoints: PresetViewpoints) -> GoldCase:
    """Return a run that passes all checks as a case for a judge."""
    return _create_case(task, episode, preset_viewpoints, None, "reference")


def _create_case(
    task: Task, episode: Episode, preset_viewpoints: PresetViewpoints, fault: ErrorMode | None, source: str
) -> GoldCase:
    facts = facts_of(task, episode.start.viewpoint or "")
    case = case_of_episode(episode, preset_viewpoints)
    return GoldCase(facts=facts, case=case, fault=fault, source=source)


async def judge_gold(
    judge: Judge, cases: Iterable[GoldCase], *, concurrency: int = 8, repeat: int = 0, note: Callable[[GoldVerdict], None]
) -> None:
    """Judge runs concurrently.

    Args:
        judge: The judge.
        cases: The runs.
        concurrency: Number of concurrent judgements.
        repeat: Index of this round of judgements, from 0.
        note: Called with each verdict as soon as it is available. Exceptions that it raises propagate to the caller.
    """
    limit = anyio.Semaphore(concurrency)

    async def judge_run(gold: GoldCase) -> None:
        async with limit:
            judgement = await judge.judge_case(gold.facts, gold.case, repeat=repeat)
        note(GoldVerdict(key=gold.key, task=gold.facts.id, fault=gold.fault, judgement=judgement))

    try:
        async with anyio.create_task_group() as group:
            for gold in cases:
                group.start_soon(judge_run, gold)
    except BaseExceptionGroup as errors:
        raise errors.exceptions[0] from None


@dataclass(frozen=True)
class GoldResult:
    """The accuracy of one judge.

    Attributes:
        judge: Name of the judge.
        runs: Number of runs, each of which may have several judgements.
        cells: Number of judgements by fault mode ("passes" for none) and by verdict: a mode, "correct", or one of
            ``WITHOUT_VERDICT``.
        verdicts: Agreement on whether a run is correct, over all judgements with a verdict.
        modes: Agreement on the error mode, over faulty runs that were judged incorrect.
    """

    judge: str
    runs: int
    cells: Mapping[tuple[str, str], int]
    verdicts: KappaResult
    modes: KappaResult

    def _count(self, *, faulty: bool, verdicts: tuple[str, ...] | None = None) -> int:
        return sum(
            number
            for (fault, verdict), number in self.cells.items()
            if (fault != PASSES) is faulty and (verdicts is None or verdict in verdicts)
        )

    @property
    def false_accept_rate(self) -> float | None:
        """Fraction of verdicts on faulty runs that are "correct"."""
        judged = self._count(faulty=True) - self._count(faulty=True, verdicts=WITHOUT_VERDICT)
        return self._count(faulty=True, verdicts=("correct",)) / judged if judged else None

    @property
    def false_reject_rate(self) -> float | None:
        """Fraction of verdicts on passing runs that are not "correct"."""
        judged = self._count(faulty=False) - self._count(faulty=False, verdicts=WITHOUT_VERDICT)
        return 1 - self._count(faulty=False, verdicts=("correct",)) / judged if judged else None

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON data."""
        matrix: dict[str, dict[str, int]] = {}
        for (fault, verdict), number in sorted(self.cells.items()):
            matrix.setdefault(fault, {})[verdict] = number
        return {
            "judge": self.judge,
            "runs": self.runs,
            "judgements": sum(self.cells.values()),
            "false_accept_rate": self.false_accept_rate,
            "false_reject_rate": self.false_reject_rate,
            "apart": {
                name: self._count(faulty=True, verdicts=(name,)) + self._count(faulty=False, verdicts=(name,))
                for name in WITHOUT_VERDICT
            },
            "matrix": matrix,
            "verdicts": self.verdicts.as_dict(),
            "modes": self.modes.as_dict(),
        }


def judge_result(judge: str, verdicts: Sequence[GoldVerdict], seed: int = 1) -> GoldResult:
    """Compare a judge's verdicts with the known faults.

    Args:
        judge: Name of the judge.
        verdicts: The judge's verdicts.
        seed: Seed for the confidence intervals.
    """
    rows = [(_fault_label(verdict), _verdict_label(verdict.judgement), verdict) for verdict in verdicts]
    judged_rows = [row for row in rows if row[1] not in WITHOUT_VERDICT]
    rejected = [row for row in judged_rows if row[0] != PASSES and row[1] != "correct"]
    return GoldResult(
        judge=judge,
        runs=len({verdict.key for verdict in verdicts}),
        cells=Counter((fault, verdict) for fault, verdict, _ in rows),
        verdicts=cohen_agreement(
            ["correct" if fault == PASSES else "incorrect" for fault, _, _ in judged_rows],
            ["correct" if verdict == "correct" else "incorrect" for _, verdict, _ in judged_rows],
            [row.task for _, _, row in judged_rows],
            seed,
        ),
        modes=cohen_agreement([r[0] for r in rejected], [r[1] for r in rejected], [r[2].task for r in rejected], seed),
    )


def judge_results(verdicts: Sequence[GoldVerdict], seed: int = 1) -> list[GoldResult]:
    """Return the result for every judge, over all of its judgements. Failed judgements that were repeated later are ignored."""
    newest = {(v.key, v.judgement.judge, v.judgement.prompt, v.judgement.repeat): v for v in verdicts}
    by_judge: dict[str, list[GoldVerdict]] = {}
    for verdict in newest.values():
        by_judge.setdefault(f"{verdict.judgement.judge} ({verdict.judgement.prompt})", []).append(verdict)
    return [judge_result(judge, rows, seed) for judge, rows in by_judge.items()]


def gold_raters(verdicts: Iterable[GoldVerdict]) -> list[Rater]:
    """Return one rater for the known faults and one for every judge, so that the agreement between them can be measured."""
    newest = {(v.key, v.judgement.judge, v.judgement.prompt, v.judgement.repeat): v for v in verdicts}
    known_faults, judges = Rater("the known faults", "gold", "gold"), dict[str, Rater]()
    by_key: dict[str, list[GoldVerdict]] = {}
    for verdict in sorted(newest.values(), key=lambda v: v.judgement.repeat):
        by_key.setdefault(verdict.key, []).append(verdict)
    for key, rows in by_key.items():
        item = RatedRun("gold", key, rows[0].task)
        add_rating(known_faults, item, "incorrect" if rows[0].fault else "correct", rows[0].fault)
        for name, group, judgement in judgements_with_raters([row.judgement for row in rows]):
            rater = judges.setdefault(name, Rater(name, "judge", f"judge:{group}"))
            add_rating(rater, item, judgement.verdict, judgement.error_mode)
    return [known_faults, *judges.values()] if by_key else []


def alternating_modes(runs: Sequence[GoldRun]) -> list[GoldRun]:
    """Return the runs in an order in which the error modes alternate. The first few runs then cover all modes."""
    by_mode = [[run for run in runs if run.mode is mode] for mode in ErrorMode]
    return [run for row in zip_longest(*by_mode) for run in row if run is not None]


def read_verdicts(path: Path) -> tuple[GoldVerdict, ...]:
    """Read the verdicts in a file. An incomplete last line is ignored.

    Raises:
        InputError: Any other line is invalid.
    """
    rows = list[GoldVerdict]()
    for number, line in complete_lines(path):
        try:
            rows.append(GoldVerdict.model_validate_json(line))
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            raise InputError(
                f"{path}, line {number} is not a verdict on a gold run: {first['msg']}. Delete the line to continue."
            ) from error
    return tuple(rows)


def _fault_label(verdict: GoldVerdict) -> str:
    return verdict.fault.value if verdict.fault else PASSES


def _verdict_label(judgement: Judgement) -> str:
    return judgement.error_mode.value if judgement.error_mode else judgement.verdict
