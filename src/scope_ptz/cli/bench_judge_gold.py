"""``scope bench judge-gold``: what a judge makes of runs whose faults are known."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench_agree import AsJson, figures
from scope_ptz.cli.bench_gold import HEADS
from scope_ptz.cli.bench_inputs import TasksOption
from scope_ptz.cli.bench_judge import TIMEOUT_S, JudgeKey, JudgeModel, JudgeOption, JudgeTimeout, JudgeUrl
from scope_ptz.cli.bench_rescore import judge_failed, them
from scope_ptz.cli.endings import FAILED, complain, ending, put, put_json
from scope_ptz.factory.judges import open_judge

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from scope_ptz.bench.judging.judgement_tally import JudgementTally
    from scope_ptz.bench.judging.server import JudgeServer
    from scope_ptz.bench.scoring.trials import Judgement
    from scope_ptz.taskgen.gold.judge_results import GoldCase, GoldResult, GoldVerdict


def judge_gold(
    out: Annotated[
        Path, typer.Option("--out", help="Verdicts, a JSON line each; those that it holds already are not asked again.")
    ],
    gold: Annotated[Path | None, typer.Option("--gold", help="File of gold runs; by default the published one.")] = None,
    tasks: TasksOption = "core",
    passing: Annotated[int, typer.Option(min=0, help="How many runs without a fault to put among them.")] = 60,
    repeats: Annotated[int, typer.Option(min=1, help="How often each run is judged.")] = 1,
    limit: Annotated[int | None, typer.Option(min=1, help="Judge only so many gold runs, of all modes in turn.")] = None,
    concurrency: Annotated[int, typer.Option(min=1, help="Judgements at a time.")] = 8,
    judge_url: JudgeUrl = None,
    judge_model: JudgeModel = None,
    judge_key_file: JudgeKey = None,
    judge_timeout: JudgeTimeout = TIMEOUT_S,
    judge_option: JudgeOption = None,
    as_json: AsJson = False,
) -> None:
    """Let a judge judge runs with known faults, and some without: false accepts, false rejects, which modes it names."""
    with ending(as_json=as_json):
        import anyio

        from scope_ptz.taskgen.gold.judge_results import read_verdicts, results

        before = read_verdicts(out)
        cases = gold_cases(gold, tasks, passing, limit)

        async def work() -> JudgementTally:
            port = await open_judge(judge_url, judge_model, judge_key_file, judge_timeout, judge_option)
            try:
                return await _judge_all(port, cases, before, out, repeats=repeats, concurrency=concurrency)
            finally:
                await port.close()

        made = anyio.run(work)
        found = results(read_verdicts(out))
        if as_json:
            put_json([result.as_dict() for result in found], indent=1)
        else:
            for result in found:
                for line in gold_lines(result):
                    put(line)
        if made.failed:
            complain(f"{judge_failed(made)} Nothing is lost; the same command asks for {them(made)} again.")
            sys.exit(FAILED)


async def _judge_all(
    port: JudgeServer, cases: Sequence[GoldCase], before: Sequence[GoldVerdict], out: Path, *, repeats: int, concurrency: int
) -> JudgementTally:
    """Judge what was not judged yet, and what came of that. A verdict that failed before is asked for again."""
    from scope_ptz.bench.judging.json_lines import append_line
    from scope_ptz.bench.judging.judge import Judge
    from scope_ptz.bench.judging.judgement_tally import JudgementTally
    from scope_ptz.bench.judging.rubrics import prompt_version
    from scope_ptz.taskgen.gold.judge_results import judge_gold as judge_cases

    name = port.client.endpoint.model
    version = prompt_version()
    done = {
        (verdict.key, verdict.judgement.repeat)
        for verdict in before
        if (verdict.judgement.judge, verdict.judgement.prompt) == (name, version) and verdict.judgement.verdict != "failed"
    }

    made: list[Judgement] = []

    def note(verdict: GoldVerdict) -> None:
        made.append(verdict.judgement)
        append_line(out, json.dumps(verdict.model_dump(mode="json"), ensure_ascii=False))

    for repeat in range(repeats):
        left = [case for case in cases if (case.key, repeat) not in done]
        complain(f"{name}: {len(left)} of {len(cases)} runs to judge" + (f", time {repeat + 1}" if repeats > 1 else ""))
        judge = Judge(name, port.repeated(repeat))
        await judge_cases(judge, left, concurrency=concurrency, repeat=repeat, note=note)
    return JudgementTally.of(made)


def gold_cases(gold: Path | None, tasks: str, passing: int, limit: int | None) -> list[GoldCase]:
    """Gold runs and, among them, runs of the same tasks that pass, made by their reference programs."""
    import anyio

    from scope_ptz.bench.program_runner import ProgramRunner
    from scope_ptz.bench.scoring.episode import PresetViewpoints
    from scope_ptz.bench.scoring.verdict import score_episode
    from scope_ptz.bench.tasks.splits import load_split, published_folder
    from scope_ptz.cli.bench_inputs import worlds_of
    from scope_ptz.factory.validation_perception import equip_with_truth
    from scope_ptz.taskgen.facts.answer_phrasing import right_answers
    from scope_ptz.taskgen.facts.robust import TASK_CAMERA
    from scope_ptz.taskgen.gold.gold_runs import read_gold
    from scope_ptz.taskgen.gold.judge_results import gold_case, in_turn, passing_case

    _, runs = read_gold(gold or published_folder() / "gold.jsonl.gz", load_split(tasks))
    runs = in_turn(runs)[:limit]
    worlds = worlds_of(run.task for run in runs)
    places = {name: PresetViewpoints.of(world.file) for name, world in worlds.items()}
    equip = equip_with_truth(worlds)
    cases = [gold_case(run, places[run.task.world]) for run in runs]

    async def add_passing() -> None:
        for task in list({run.task.id: run.task for run in runs}.values())[:passing]:
            answer, outcome = right_answers(task.expected)[0], task.behaviour.outcomes[0]
            episode = await ProgramRunner(worlds[task.world], equip, TASK_CAMERA).run(task, task.reference, answer, outcome)
            if score_episode(task, episode).headline == "correct":
                cases.append(passing_case(task, episode, places[task.world]))

    anyio.run(add_passing)
    return cases


def gold_lines(result: GoldResult) -> Iterator[str]:
    """What a judge made of gold runs, as text."""
    from scope_ptz.bench.scoring.error_modes import ErrorMode
    from scope_ptz.taskgen.gold.judge_results import PASSES, WITHOUT_VERDICT

    modes = [mode.value for mode in ErrorMode]
    columns = [*modes, "correct", *WITHOUT_VERDICT]
    made = sum(result.cells.values())
    times = f", {made} judgements" if made != result.runs else ""
    runs = f"{result.runs} gold run{'' if result.runs == 1 else 's'}"
    yield f"{result.judge}: {runs}{times}; rows: the fault put in, columns: what was said"
    yield f"{'':<20}" + "".join(f"{HEADS.get(name, name):>12}" for name in columns)
    for row in (*modes, PASSES):
        if any(fault == row for fault, _ in result.cells):
            yield f"{row.replace('_', ' '):<20}" + "".join(f"{result.cells.get((row, name), 0) or '.':>12}" for name in columns)
    for what, share in (("false accepts", result.false_accept_rate), ("false rejects", result.false_reject_rate)):
        yield f"{what}: {f'{share:.1%}' if share is not None else 'not measured'}"
    yield f"correct or not: {figures(result.verdicts)}"
    yield f"error mode, of faulty runs that it condemned: {figures(result.modes)}"
