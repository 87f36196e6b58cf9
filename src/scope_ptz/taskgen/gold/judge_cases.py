"""Test a judge on gold runs: select the runs, request judgements, and format the result as lines of text."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import anyio

from scope_ptz.bench.judging.agreement_text import agreement_text
from scope_ptz.bench.judging.json_lines import append_line
from scope_ptz.bench.judging.judge import Judge
from scope_ptz.bench.judging.judgement_tally import JudgementTally
from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.judging.server import JudgeServer
from scope_ptz.bench.program_runner import MakeToolContext, ProgramRunner
from scope_ptz.bench.scoring.episode import PresetViewpoints
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Judgement
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.splits import load_split, published_folder
from scope_ptz.bench.tasks.task import Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers
from scope_ptz.taskgen.facts.robust import TASK_CAMERA
from scope_ptz.taskgen.gold.gold_runs import read_gold
from scope_ptz.taskgen.gold.judge_results import (
    PASSES,
    WITHOUT_VERDICT,
    GoldCase,
    GoldResult,
    GoldVerdict,
    alternating_modes,
    gold_case,
    passing_case,
)
from scope_ptz.taskgen.gold.judge_results import judge_gold as judge_cases
from scope_ptz.taskgen.gold.reference_runs import COLUMN_NAMES


async def judge_all(
    server: JudgeServer,
    cases: Sequence[GoldCase],
    earlier: Sequence[GoldVerdict],
    out: Path,
    *,
    repeats: int,
    concurrency: int,
    notify: Callable[[str], None],
) -> JudgementTally:
    """Judge the cases that have no verdict yet, and append the verdicts to a file. Failed judgements are requested again.

    Args:
        server: The judge's server.
        cases: Runs to judge.
        earlier: Verdicts that the file already contains.
        out: File to which the verdicts are appended.
        repeats: Number of judgements of each run.
        concurrency: Number of concurrent judgements.
        notify: Called with a note before each round of judgements.
    """
    name = server.client.endpoint.model
    version = prompt_version()
    judged = {
        (verdict.key, verdict.judgement.repeat)
        for verdict in earlier
        if (verdict.judgement.judge, verdict.judgement.prompt) == (name, version) and verdict.judgement.verdict != "failed"
    }

    judgements: list[Judgement] = []

    def record(verdict: GoldVerdict) -> None:
        judgements.append(verdict.judgement)
        append_line(out, json.dumps(verdict.model_dump(mode="json"), ensure_ascii=False))

    for repeat in range(repeats):
        remaining = [case for case in cases if (case.key, repeat) not in judged]
        notify(f"{name}: {len(remaining)} of {len(cases)} runs to judge" + (f", judgement {repeat + 1}" if repeats > 1 else ""))
        judge = Judge(name, server.for_repeat(repeat))
        await judge_cases(judge, remaining, concurrency=concurrency, repeat=repeat, note=record)
    return JudgementTally.of(judgements)


def create_cases(
    gold: Path | None,
    split: str,
    passing: int,
    limit: int | None,
    open_worlds: Callable[[Iterable[Task]], Mapping[str, Scene]],
    ground_truth_tools: Callable[[Mapping[str, Scene]], MakeToolContext],
) -> list[GoldCase]:
    """Return gold runs, and passing runs for the same tasks, as cases for a judge. Reference programs produce the passing runs.

    Args:
        gold: Gold run file; None for the published one.
        split: Split or task file that contains the tasks of the runs.
        passing: Maximum number of passing runs.
        limit: Maximum number of gold runs; None for all.
        open_worlds: Opens the scenes and variations that tasks use.
        ground_truth_tools: Returns a function that creates tool contexts with ground-truth perception.
    """
    _, runs = read_gold(gold or published_folder() / "gold.jsonl.gz", load_split(split))
    runs = alternating_modes(runs)[:limit]
    worlds = open_worlds(run.task for run in runs)
    preset_viewpoints = {name: PresetViewpoints.of(world.file) for name, world in worlds.items()}
    make_context = ground_truth_tools(worlds)
    cases = [gold_case(run, preset_viewpoints[run.task.world]) for run in runs]

    async def add_passing() -> None:
        for task in list({run.task.id: run.task for run in runs}.values())[:passing]:
            answer, outcome = correct_answers(task.expected)[0], task.behaviour.outcomes[0]
            episode = await ProgramRunner(worlds[task.world], make_context, TASK_CAMERA).run(task, task.reference, answer, outcome)
            if score_episode(task, episode).headline == "correct":
                cases.append(passing_case(task, episode, preset_viewpoints[task.world]))

    anyio.run(add_passing)
    return cases


def result_lines(result: GoldResult) -> Iterator[str]:
    """Yield a judge's confusion matrix on gold runs, with its false-accept and false-reject rates, as lines of text."""
    modes = [mode.value for mode in ErrorMode]
    columns = [*modes, "correct", *WITHOUT_VERDICT]
    judgements = sum(result.cells.values())
    judgement_count = f", {judgements} judgements" if judgements != result.runs else ""
    runs = f"{result.runs} gold run{'' if result.runs == 1 else 's'}"
    yield f"{result.judge}: {runs}{judgement_count}; rows: inserted fault, columns: the judge's verdict"
    yield f"{'':<20}" + "".join(f"{COLUMN_NAMES.get(name, name):>12}" for name in columns)
    for row in (*modes, PASSES):
        if any(fault == row for fault, _ in result.cells):
            yield f"{row.replace('_', ' '):<20}" + "".join(f"{result.cells.get((row, name), 0) or '.':>12}" for name in columns)
    for name, share in (("false accepts", result.false_accept_rate), ("false rejects", result.false_reject_rate)):
        yield f"{name}: {f'{share:.1%}' if share is not None else 'not measured'}"
    yield f"correct or not: {agreement_text(result.verdicts)}"
    yield f"error mode of the faulty runs that it rejected: {agreement_text(result.modes)}"
