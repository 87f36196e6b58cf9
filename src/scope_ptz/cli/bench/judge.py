"""Judge commands: ``rescore`` logs, measure agreement (``agree``), and test a judge on known faults (``judge-gold``)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench.flags import GoldOption, TasksOption, judge_settings
from scope_ptz.cli.bench.verify import print_findings, read_log
from scope_ptz.cli.exit import FAILED, print_error, put, put_json
from scope_ptz.cli.options import JsonOption, JudgeFlags
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scope_ptz.bench.judging.agreement import Rater
    from scope_ptz.bench.judging.judgement_tally import JudgementTally
    from scope_ptz.bench.judging.server import JudgeServer

DEFAULT_CONCURRENCY = 8


def rescore(
    logs: Annotated[list[Path], typer.Argument(help="Logs of finished evaluations. Scores are added; none are removed.")],
    judge: JudgeFlags,
    checks: Annotated[bool, typer.Option("--checks", help="Apply this version's executable checks again.")] = False,
    repeats: Annotated[int, typer.Option("--judge-repeats", min=1, help="Number of judgements to add to each run.")] = 1,
    concurrency: Annotated[
        int, typer.Option("--concurrency", min=1, max=256, help="Number of runs to judge at a time.")
    ] = DEFAULT_CONCURRENCY,
    decides: Annotated[
        str,
        typer.Option("--decides", metavar="JUDGE", help="Judge whose verdicts count for runs that only a judge can score."),
    ] = "",
) -> int:
    """Add verdicts of a judge (--judge-url) or of the installed checks (--checks) to logs. The agent is not run again.

    For runs that only a judge can score, the verdicts of the first judge count until --decides names another.

    Running the same command again resumes an interrupted rescoring: only missing judgements are requested. The exit
    code is 1 if any judgement fails.
    """
    import anyio

    from scope_ptz.bench.judging.deciding_judge import other_judges_note
    from scope_ptz.bench.judging.judgement_tally import JudgementTally
    from scope_ptz.factory.evaluate import require_engine

    require_engine()
    from scope_ptz.bench.engine.rescoring import set_deciding_judge
    from scope_ptz.factory.evaluation import eval_context
    from scope_ptz.factory.rescore import add_scores, open_requested_judge

    settings = judge_settings(judge, repeats)
    if not checks and not settings.requested and not decides:
        raise InputError("No scorer is selected. Give a judge (--judge-url), the checks (--checks), or both.")

    async def work() -> JudgementTally:
        total = JudgementTally()
        server = await open_requested_judge(settings) if settings.requested else None
        try:
            for log in logs:
                print_findings(read_log(log))
                if checks or server is not None:
                    tally = await add_scores(
                        log,
                        server,
                        eval_context(seed=1),
                        repeats=repeats,
                        checks=checks,
                        concurrency=concurrency,
                        notify=print_error,
                    )
                    total += tally
                    parts = ["checked again"] if checks else []
                    put(f"{log}: {', '.join([*parts, *_judgement_notes(server, tally)])}")
                if decides:
                    set_deciding_judge(log, decides)
                if note := other_judges_note(read_log(log).trials):
                    put(f"{log}: {note}")
        finally:
            if server is not None:
                await server.close()
        return total

    total = anyio.run(work)
    if total.failed:
        print_error(retry_message(total))
        return FAILED
    return 0


def _judgement_notes(judge: JudgeServer | None, tally: JudgementTally) -> list[str]:
    """Describe the new judgements in a log."""
    if judge is None:
        return []
    return [f"{tally.total} judgement{'' if tally.total == 1 else 's'} by {judge.client.endpoint.model}: {tally.summary}"]


def judge_failure_text(tally: JudgementTally) -> str:
    """Return a sentence about the judgements that failed because of the judge's server."""
    cause = f", the first with: {tally.failure}" if tally.failure else ""
    cause = cause if cause.endswith((".", "!", "?")) else f"{cause}."
    return f"{tally.failed} of {tally.total} judgements failed because the judge's server gave no usable reply{cause}"


def retry_message(tally: JudgementTally) -> str:
    """Return a message about failed judgements that states how to retry them."""
    pronoun = "it" if tally.failed == 1 else "them"
    return f"{judge_failure_text(tally)} Nothing is lost; running the same command again retries {pronoun}."


def agree(
    logs: Annotated[
        list[Path],
        typer.Argument(help="Logs with judgements or labels, and verdicts on gold runs (.jsonl files written by judge-gold)."),
    ],
    as_json: JsonOption = False,
    seed: Annotated[int, typer.Option(help="Seed for the bootstrap.")] = 1,
) -> None:
    """Measure the agreement between judges, repeated judgements, the executable checks, human labels and known faults.

    Prints raw agreement, Cohen's kappa (pairs), Fleiss' kappa (groups), and 95% intervals.
    """
    from scope_ptz.bench.judging.agreement import measure_agreement
    from scope_ptz.bench.judging.agreement_text import agreement_lines

    report = measure_agreement(raters_in(logs), seed)
    if as_json:
        put_json(report.as_dict(), indent=1)
    else:
        for line in agreement_lines(report):
            put(line)


def raters_in(logs: Sequence[Path]) -> list[Rater]:
    """Return the raters in logs and gold verdict files. Raises ``InputError`` or ``TraceError``."""
    from scope_ptz.bench.judging.agreement import collect_raters
    from scope_ptz.bench.judging.human_labels import labels_file, read_labels, with_labels
    from scope_ptz.taskgen.gold.judge_results import gold_raters, read_verdicts

    verdict_files = [path for path in logs if path.suffix == ".jsonl"]
    evaluations = []
    for path in logs:
        if path not in verdict_files:
            evaluations.append(with_labels(read_log(path), read_labels(labels_file(path))))
    verdicts = [verdict for path in verdict_files for verdict in read_verdicts(path)]
    return [*collect_raters(evaluations), *gold_raters(verdicts)]


def judge_gold(
    out: Annotated[Path, typer.Option("--out", help="File for verdicts (JSONL). Verdicts already in it are not requested again.")],
    judge: JudgeFlags,
    gold: GoldOption = None,
    tasks: TasksOption = "core",
    passing: Annotated[int, typer.Option(min=0, help="Number of runs without faults to add.")] = 60,
    repeats: Annotated[int, typer.Option(min=1, help="Number of judgements per run.")] = 1,
    limit: Annotated[int | None, typer.Option(min=1, help="Judge at most N gold runs, taken from all error modes in turn.")] = None,
    concurrency: Annotated[int, typer.Option(min=1, help="Number of judgements at a time.")] = DEFAULT_CONCURRENCY,
    as_json: JsonOption = False,
) -> int:
    """Test a judge on runs with known faults, mixed with runs without faults.

    Prints false accepts, false rejects, and the error modes that the judge names.
    """
    import anyio

    from scope_ptz.factory.rescore import open_requested_judge
    from scope_ptz.factory.validation_perception import ground_truth_tools
    from scope_ptz.factory.worlds import open_worlds
    from scope_ptz.taskgen.gold.judge_cases import create_cases, judge_all, result_lines
    from scope_ptz.taskgen.gold.judge_results import judge_results, read_verdicts

    earlier_verdicts = read_verdicts(out)
    cases = create_cases(gold, tasks, passing, limit, open_worlds, ground_truth_tools)

    async def work() -> JudgementTally:
        server = await open_requested_judge(judge_settings(judge))
        try:
            return await judge_all(
                server, cases, earlier_verdicts, out, repeats=repeats, concurrency=concurrency, notify=print_error
            )
        finally:
            await server.close()

    tally = anyio.run(work)
    results = judge_results(read_verdicts(out))
    if as_json:
        put_json([result.as_dict() for result in results], indent=1)
    else:
        for result in results:
            for line in result_lines(result):
                put(line)
    if tally.failed:
        print_error(retry_message(tally))
        return FAILED
    return 0
