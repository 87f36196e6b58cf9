"""``scope bench run``: run an evaluation, or resume an interrupted one."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import TYPE_CHECKING

from scope_ptz.cli.bench.agent_flags import AgentFlags, agent_options
from scope_ptz.cli.bench.flags import (
    JudgeRepeatsOption,
    SelectionFlags,
    SingleEvaluationFlags,
    evaluation_options,
    judge_settings,
    parse_price,
)
from scope_ptz.cli.exit import FAILED, print_error, put, put_json
from scope_ptz.cli.options import JsonOption, JudgeFlags, PairFlags

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import Console

    from scope_ptz.factory.evaluation_options import EvaluationOptions, EvaluationResult


def run(
    selection: SelectionFlags,
    evaluation: SingleEvaluationFlags,
    agent: AgentFlags,
    models: PairFlags,
    judge: JudgeFlags,
    judge_repeats: JudgeRepeatsOption = 1,
    as_json: JsonOption = False,
) -> int:
    """Run a planner with a perception backend, or an external agent, on the benchmark, and print the scores.

    Without options, the built-in planner and ground-truth perception run the published core tasks.
    This needs neither a server nor a key.

    Running the same command again resumes an interrupted evaluation.

    The exit code is 1 if runs are missing or failed because of infrastructure.
    """
    from rich.console import Console

    from scope_ptz.bench.engine.run_totals import evaluation_summary
    from scope_ptz.cli.bench.progress import summary

    judge_options = judge_settings(judge, judge_repeats)
    options = replace(
        evaluation_options(selection, evaluation, models.options()),
        agent=agent.agent,
        agent_options=agent_options(agent),
        pictures=evaluation.pictures,
        variant=evaluation.variant,
        fresh=evaluation.fresh,
        resume=evaluation.resume,
        price=parse_price(evaluation.price),
        judge=judge_options if judge_options.requested else None,
    )
    console = Console(highlight=False, stderr=as_json)

    result = _evaluate(options, console, evaluation.progress)
    if as_json:
        judgements = {"judge": result.judge, "judgements": asdict(result.judgements)} if result.judgements is not None else {}
        put_json(evaluation_summary(result.evaluation) | judgements)
    else:
        console.print(summary(result.evaluation))
        if result.judgements is not None:
            put(f"judge      {result.judge}: {result.judgements.summary}")
        put(f"log        {result.evaluation.log}")
    return _report_failures(result)


def _evaluate(options: EvaluationOptions, console: Console, progress_folder: Path | None) -> EvaluationResult:
    """Run the evaluation, show its progress in the terminal and, if there is a ``progress_folder``, write progress files to it."""
    from contextlib import closing

    from scope_ptz.cli.bench.progress import LiveProgress
    from scope_ptz.cli.exit import run_async
    from scope_ptz.factory.evaluate import evaluate, require_engine

    require_engine()
    results: list[EvaluationResult] = []
    if progress_folder is None:

        async def work() -> None:
            results.append(await evaluate(options, progress=LiveProgress(console)))

        run_async(work)
        return results[0]
    from scope_ptz.factory.progress_files import ProgressFiles, ProgressGroup

    with closing(ProgressFiles(progress_folder)) as progress:

        async def work_with_files() -> None:
            results.append(await evaluate(options, progress=ProgressGroup(LiveProgress(console), progress)))

        run_async(work_with_files)
        progress.finish(results[0])
    return results[0]


def _report_failures(result: EvaluationResult) -> int:
    """Print the failures and how to repeat the failed runs, and return the exit code."""
    from scope_ptz.bench.engine.failure_summary import failure_summary
    from scope_ptz.cli.bench.judge import judge_failure_text

    evaluation, judgements = result.evaluation, result.judgements
    broken = sum(trial.headline == "infrastructure" for trial in evaluation.trials)
    missing = max(evaluation.wanted - len(evaluation.trials), 0)
    for line in failure_summary(evaluation.trials, evaluation.card):
        print_error(line)
    if broken or missing:
        parts = []
        if broken:
            parts.append(f"{broken} {'run' if broken == 1 else 'runs'} failed because of infrastructure")
        if missing:
            parts.append(f"{missing} {'run is' if missing == 1 else 'runs are'} missing")
        print_error(f"{' and '.join(parts)}; running the same command again repeats {'it' if broken + missing == 1 else 'them'}.")
    judging_failed = judgements is not None and judgements.failed
    if judgements is not None and judging_failed:
        print_error(
            f"{judge_failure_text(judgements)} No run is lost. Run the same command again to retry, or "
            f"`scope bench rescore {evaluation.log} --judge-url ...`."
        )
    return FAILED if broken or missing or judging_failed else 0
