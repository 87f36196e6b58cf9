"""``scope bench rescore``: judge logs, or check them again, without running the agent."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench_judge import TIMEOUT_S, JudgeKey, JudgeModel, JudgeOption, JudgeTimeout, JudgeUrl
from scope_ptz.cli.endings import FAILED, complain, ending, put
from scope_ptz.errors import InputError
from scope_ptz.factory.judges import open_judge

if TYPE_CHECKING:
    from scope_ptz.bench.engine.context import EvalContext
    from scope_ptz.bench.judging.judgement_tally import JudgementTally
    from scope_ptz.bench.judging.server import JudgeServer


AT_A_TIME = 8
"""Runs that are judged at the same time."""


def rescore(
    logs: Annotated[list[Path], typer.Argument(help="Logs of finished evaluations. Scores are added to them; none is lost.")],
    checks: Annotated[bool, typer.Option("--checks", help="Run the executable checks of this version again.")] = False,
    repeats: Annotated[int, typer.Option("--judge-repeats", min=1, help="Judgements of each run, beside those there are.")] = 1,
    concurrency: Annotated[int, typer.Option("--concurrency", min=1, max=256, help="Runs judged at a time.")] = AT_A_TIME,
    decides: Annotated[
        str,
        typer.Option("--decides", metavar="JUDGE", help="Whose verdicts count from now on where only a judge can score."),
    ] = "",
    judge_url: JudgeUrl = None,
    judge_model: JudgeModel = None,
    judge_key_file: JudgeKey = None,
    judge_timeout: JudgeTimeout = TIMEOUT_S,
    judge_option: JudgeOption = None,
) -> None:
    """Add a judge's verdicts to logs (--judge-url), or those of today's checks (--checks). The agent is not run again.

    Where only a judge can score, the first judge goes on deciding when another is added; --decides names another.

    Judgements that were made before a break are kept: the same command asks only for the rest. Exit code 1 when the judge's server
    failed on any; the same command asks for those again.
    """
    with ending():
        import anyio

        from scope_ptz.bench.judging.deciding_judge import other_judges_note
        from scope_ptz.bench.judging.judgement_tally import JudgementTally
        from scope_ptz.cli.bench_evaluate import need_engine
        from scope_ptz.factory.evaluation import eval_context
        from scope_ptz.settings import load_settings

        need_engine()
        from scope_ptz.bench.engine.logs import read_evaluation
        from scope_ptz.bench.engine.rescoring import let_decide

        wants_judge = bool(judge_url or judge_model or load_settings().judge_url)
        if not checks and not wants_judge and not decides:
            raise InputError("Say what to score by: a judge (--judge-url), the checks (--checks), or both.")

        async def work() -> JudgementTally:
            all_made = JudgementTally()
            judge = await open_judge(judge_url, judge_model, judge_key_file, judge_timeout, judge_option) if wants_judge else None
            try:
                for log in logs:
                    if checks or wants_judge:
                        lent = eval_context(seed=1, judge=judge)
                        made = await score_again(log, judge, lent, repeats=repeats, checks=checks, at_a_time=concurrency)
                        all_made += made
                        put(f"{log}: {'checked again' if checks else ''}{', ' if checks and judge else ''}{told(judge, made)}")
                    if decides:
                        let_decide(log, decides)
                    if several := other_judges_note(read_evaluation(log).trials):
                        put(f"{log}: {several}")
            finally:
                if judge is not None:
                    await judge.close()
            return all_made

        all_made = anyio.run(work)
        if all_made.failed:
            complain(f"{judge_failed(all_made)} Nothing is lost; the same command asks for {them(all_made)} again.")
            sys.exit(FAILED)


def told(judge: JudgeServer | None, made: JudgementTally) -> str:
    """What came of a log's judgements."""
    if judge is None:
        return ""
    return f"{made.made} judgement{'' if made.made == 1 else 's'} by {judge.client.endpoint.model}: {made.summary}"


def judge_failed(made: JudgementTally) -> str:
    """The sentence about judgements that a judge's server failed on."""
    first = f", the first with: {made.failure}" if made.failure else ""
    first = first if first.endswith((".", "!", "?")) else f"{first}."
    return f"{made.failed} of {made.made} judgements failed because the judge's server gave no usable reply{first}"


def them(made: JudgementTally) -> str:
    """The judgements that failed, as a pronoun."""
    return "it" if made.failed == 1 else "them"


async def score_again(
    log: Path,
    judge: JudgeServer | None,
    lent: EvalContext,
    *,
    repeats: int,
    more: bool = True,
    checks: bool = False,
    at_a_time: int,
) -> JudgementTally:
    """Add scores to a log; what came of the judgements. ``more``: beside those there are, not in place of what is missing."""
    from scope_ptz.bench.engine.context import EQUIPMENT
    from scope_ptz.bench.engine.rescoring import rescore as again
    from scope_ptz.factory.judge_role import judge_as_model

    EQUIPMENT.set(lent)

    def say(done: int, of: int) -> None:
        if done % 25 == 0 or done == of:
            complain(f"{log.name}: {done} of {of}")

    model = judge_as_model(judge, at_a_time) if judge is not None else None
    return await again(log, judge_model=model, repeats=repeats, more=more, with_checks=checks, at_a_time=at_a_time, say=say)
