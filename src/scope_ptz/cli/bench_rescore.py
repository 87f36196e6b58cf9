"""``scope bench rescore``: judge logs, or check them again, without running the agent."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench_judge import TIMEOUT_S, JudgeKey, JudgeModel, JudgeOption, JudgeTimeout, JudgeUrl, open_judge
from scope_ptz.cli.endings import complain, ending, put
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.bench.judging.server import ServerPort


def rescore(
    logs: Annotated[list[Path], typer.Argument(help="Logs of finished evaluations. Scores are added to them; none is lost.")],
    checks: Annotated[bool, typer.Option("--checks", help="Run the executable checks of this version again.")] = False,
    repeats: Annotated[int, typer.Option("--judge-repeats", min=1, help="Judgements of each run, beside those there are.")] = 1,
    concurrency: Annotated[int, typer.Option("--concurrency", min=1, max=256, help="Runs judged at a time.")] = 8,
    judge_url: JudgeUrl = None,
    judge_model: JudgeModel = None,
    judge_key_file: JudgeKey = None,
    judge_timeout: JudgeTimeout = TIMEOUT_S,
    judge_option: JudgeOption = None,
) -> None:
    """Add a judge's verdicts to logs (--judge-url), or those of today's checks (--checks). The agent is not run again.

    Judgements that were made before a break are kept: the same command asks only for the rest.
    """
    with ending():
        import anyio

        from scope_ptz.cli.bench_evaluate import need_engine
        from scope_ptz.settings import load_settings

        need_engine()
        wants_judge = bool(judge_url or judge_model or load_settings().judge_url)
        if not checks and not wants_judge:
            raise InputError("Say what to score by: a judge (--judge-url), the checks (--checks), or both.")

        async def work() -> None:
            judge = await open_judge(judge_url, judge_model, judge_key_file, judge_timeout, judge_option) if wants_judge else None
            try:
                for log in logs:
                    made = await _one(log, judge, repeats=repeats, checks=checks, at_a_time=concurrency)
                    put(f"{log}: {'checked again' if checks else ''}{', ' if checks and judge else ''}{_told(judge, made)}")
            finally:
                if judge is not None:
                    await judge.close()

        anyio.run(work)


def _told(judge: ServerPort | None, made: int) -> str:
    return f"{made} judgements by {judge.client.endpoint.model}" if judge is not None else ""


async def _one(log: Path, judge: ServerPort | None, *, repeats: int, checks: bool, at_a_time: int) -> int:
    from scope_ptz.bench.engine.equipment import EQUIPMENT
    from scope_ptz.bench.engine.rescoring import rescore as again
    from scope_ptz.cli.bench_equipment import lend
    from scope_ptz.cli.bench_judging import judge_as_model

    EQUIPMENT.set(lend(seed=1, judge=judge))

    def say(done: int, of: int) -> None:
        if done % 25 == 0 or done == of:
            complain(f"{log.name}: {done} of {of}")

    model = judge_as_model(judge, at_a_time) if judge is not None else None
    return await again(log, judge_model=model, repeats=repeats, with_checks=checks, at_a_time=at_a_time, say=say)
