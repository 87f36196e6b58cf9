"""Validate a dataset: run every attempt at every task with the real tools, and score it."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

from scope_ptz.bench.program_runner import MakeToolContext, ProgramRunner
from scope_ptz.bench.scoring.episode import Episode
from scope_ptz.bench.scoring.misperceptions import has_wrong_reply
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.expected import NoneThere, Number
from scope_ptz.bench.tasks.task import Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import view_truth
from scope_ptz.taskgen.facts.robust import TASK_CAMERA
from scope_ptz.taskgen.validation.adaptive import Form, adaptive_attempts, common_answers_by_form
from scope_ptz.taskgen.validation.adversarial import (
    Attempt,
    adversarial_attempts,
    common_answers,
    correct_attempts,
    guess_attempts,
    other_correct_wordings,
)
from scope_ptz.taskgen.validation.consistency import TruthReader, find_inconsistencies
from scope_ptz.taskgen.validation.dataset_checks import check_adaptive, check_guesses, sibling_answers, structural_faults
from scope_ptz.taskgen.validation.validation_report import ValidationFault, ValidationReport

Progress = Callable[[int, int], None]
"""A function that receives the number of validated tasks and the total."""

_FALLBACK_GUESS = "2"  # used for a category that has no most common answer


async def validate(
    tasks: Sequence[Task],
    scenes: Mapping[str, Scene],
    make_context: MakeToolContext,
    *,
    seed: int = 1,
    read_truth: TruthReader = view_truth,
    progress: Progress | None = None,
    dataset: Sequence[Task] = (),
) -> ValidationReport:
    """Run every attempt at every task. Correct attempts must pass, and adversarial attempts must fail.

    Args:
        tasks: The tasks.
        scenes: The scenes and variations that the tasks use, by name.
        make_context: Creates the tool context for a camera.
        seed: Seed for the wrong answers.
        read_truth: Reads the ground truth of a view. A function with a cache makes validation much faster.
        progress: Called after every task with the number of validated tasks and the total.
        dataset: The whole dataset, if ``tasks`` is a selection from it. It may contain twins and paraphrased tasks.

    Returns:
        The report.
    """
    common_forms = common_answers_by_form(tasks)
    report, common, common_unpaired = ValidationReport(), common_answers(tasks), common_answers(tasks, exclude_pairs=True)
    siblings = sibling_answers(tasks)
    runners = {name: ProgramRunner(scene, make_context, TASK_CAMERA) for name, scene in scenes.items()}
    world = ""
    # Tasks are sorted by scene, and the images of a scene are released after its last task to save memory.
    for number, task in enumerate(sorted(tasks, key=lambda task: task.world), 1):
        if world and world != task.world:
            scenes[world].release()
        world = task.world
        _count_task(report, task)
        reasons = find_inconsistencies(task, scenes[task.world], read_truth)
        report.faults += [ValidationFault(task.id, "truth", reason) for reason in reasons]
        if task.preset not in {preset.name for preset in scenes[task.world].file.presets}:
            continue  # programs cannot start without their preset
        validation = _TaskValidation(report, task, runners[task.world])
        await validation.run(common.get(task.category, _FALLBACK_GUESS), siblings.get(task.id), seed)
        if task.stratum == "core":
            await validation.guess(common_unpaired.get(task.category, _FALLBACK_GUESS))
            await validation.adapt(common_forms)
        if progress is not None:
            progress(number, len(tasks))
    report.faults += structural_faults(tasks, dataset)
    check_guesses(report, tasks)
    check_adaptive(report, tasks)
    return report


def _count_task(report: ValidationReport, task: Task) -> None:
    report.tasks += 1
    report.by_stratum[task.stratum] += 1
    if task.stratum == "core":
        report.by_category[task.category] += 1
        report.absences += isinstance(task.expected, NoneThere) and task.pair is not None
        report.from_start += not task.needs


class _TaskValidation:
    """Validates one task. Attempts with the same program share its run."""

    def __init__(self, report: ValidationReport, task: Task, runner: ProgramRunner) -> None:
        self.report, self.task, self.runner = report, task, runner
        self._episodes: dict[str, Episode] = {}

    async def run(self, common: str, sibling: str | None, seed: int) -> None:
        """Run the correct and the adversarial attempts."""
        for attempt in correct_attempts(self.task):
            await self._check(attempt, attempt.name, passes=True)
        for text in other_correct_wordings(self.task):
            await self._check(Attempt("worded", self.task.reference, text, self.task.behaviour.outcomes[0]), "worded", passes=True)
        self._compare_with_evidence(await self._episode(Attempt("reference", self.task.reference, "")))
        counted_names = set[str]()
        for attempt in adversarial_attempts(self.task, common, sibling, random.Random(f"{seed}:{self.task.id}")):
            # The four guesses count as one attempt.
            counted = attempt.name in counted_names
            counted_names.add(attempt.name)
            await self._check(attempt, attempt.name, passes=False, counted=counted)

    async def guess(self, common: str) -> None:
        """Record which fixed answers pass the task by chance."""
        await self._record_passed(self.report.guessed, guess_attempts(self.task, common))

    async def adapt(self, common: Mapping[Form, str]) -> None:
        """Record which adaptive agents pass the task by chance."""
        await self._record_passed(self.report.adaptive, adaptive_attempts(self.task, common))

    async def _record_passed(self, passed_by: dict[str, set[str]], attempts: Iterable[Attempt]) -> None:
        for attempt in attempts:
            passed = passed_by.setdefault(attempt.name, set())
            if score_episode(self.task, await self._episode(attempt)).headline == "correct":
                passed.add(self.task.id)

    async def _episode(self, attempt: Attempt) -> Episode:
        key = str([(call.tool, call.arguments) for call in attempt.program])
        if key not in self._episodes:
            self._episodes[key] = await self.runner.run(self.task, attempt.program, attempt.text, attempt.outcome)
        return replace(self._episodes[key], answer=attempt.text, outcome=attempt.outcome)

    async def _check(self, attempt: Attempt, name: str, *, passes: bool, counted: bool = False) -> None:
        """Run an attempt, and record a fault if its result is not the expected one.

        Args:
            attempt: The attempt.
            name: The attempt's name in the report.
            passes: Whether the attempt must pass.
            counted: Whether an attempt with this name has already been counted for the task.
        """
        verdict = score_episode(self.task, await self._episode(attempt))
        passed = verdict.headline == "correct"
        self.report.tried[name] += not counted
        self.report.passed[name] += passed
        if passed != passes:
            fault = ValidationFault(self.task.id, name, f"{attempt.text!r}: {verdict.reason}")
            (self.report.faults if passes else self.report.adversarial_passes).append(fault)

    def _compare_with_evidence(self, episode: Episode) -> None:
        """Record the counts and answers of perception that differ from the evidence."""
        if has_wrong_reply(self.task, episode):
            answers = "; ".join(str(call.result["answer"]) for call in episode.calls if call.result and "answer" in call.result)
            reason = f"the evidence does not agree with the answers: {answers}"
            self.report.disagreements.append(ValidationFault(self.task.id, "query", reason))
        counts = [call for call in episode.calls if call.name == "count_objects" and call.result is not None]
        shows = [view.shows for view in self.task.evidence if isinstance(view.shows, Number | NoneThere)]
        for call, shown in zip(counts, shows, strict=False):
            expected = shown.value if isinstance(shown, Number) else 0
            count = (call.result or {}).get("count")
            if count != expected:
                reason = f"count_objects({call.arguments['description']}) returns {count}, the evidence shows {expected:g}"
                self.report.disagreements.append(ValidationFault(self.task.id, "count", reason))
