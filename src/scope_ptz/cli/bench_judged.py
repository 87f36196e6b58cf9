"""An evaluation that was to be judged: asking the judge for what is missing, also after its server had failed."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.cli.bench_rescore import AT_A_TIME, score_again
from scope_ptz.cli.endings import complain

if TYPE_CHECKING:
    from scope_ptz.bench.engine.context import EvalContext
    from scope_ptz.bench.judging.judgement_tally import JudgementTally
    from scope_ptz.bench.judging.server import JudgeServer
    from scope_ptz.bench.scoring.trials import Evaluation


@dataclass(frozen=True, slots=True)
class JudgeOptions:
    """A judge's server, and how often it judges each run."""

    url: str | None
    model: str | None
    key_file: Path | None
    timeout_s: float
    options: tuple[str, ...] = ()
    repeats: int = 1


@dataclass(frozen=True, slots=True)
class Ended:
    """How an evaluation stands. ``judge``: the name of the one that was to judge, and what came of it; empty without one."""

    evaluation: Evaluation
    judge: str = ""
    judged: JudgementTally | None = None


async def open_wished(wish: JudgeOptions) -> JudgeServer:
    """The port to the judge that is wished for. Raises ``InputError``."""
    from scope_ptz.factory.judges import open_judge

    return await open_judge(wish.url, wish.model, wish.key_file, wish.timeout_s, list(wish.options))


async def judged(
    log: Path, wish: JudgeOptions, opened: Callable[[], Awaitable[JudgeServer]], lent: EvalContext, *, again: bool
) -> Ended:
    """A log as it stands, when the judge has been asked about the runs that it was not asked about yet. ``again``: also about those
    on which its server failed; ``opened``: its port, which is not wanted when nothing is left to ask."""
    from scope_ptz.bench.engine.logs import read_evaluation
    from scope_ptz.bench.judging.judgement_tally import JudgementTally, judged_by, requested_judgements
    from scope_ptz.factory.evaluation import judge_maker
    from scope_ptz.factory.judges import UnnamedJudgeError
    from scope_ptz.settings import load_settings

    evaluation = read_evaluation(log)
    asked = wish.model or load_settings().judge_model
    if not asked:
        try:
            asked = (await opened()).client.endpoint.model
        except UnnamedJudgeError as error:
            name = judged_by(evaluation.trials, "", wish.repeats)
            if name is None:
                raise
            complain(f"{error} Every run has been judged by {name}: that is what is told here.")
            asked = name
    name = judged_by(evaluation.trials, asked, wish.repeats)
    if name is None:
        judge = await opened()
        name = judge.client.endpoint.model
        there = requested_judgements(evaluation.trials, name, wish.repeats)
        missing = sum(judgement is None or judgement.verdict == "failed" for judgement in there)
        if evaluation.finished and (None in there or (again and missing)):
            complain(f"{missing} of {len(there)} judgements by {name} are missing: it is asked for them now.")
            lent = replace(lent, make_judge=judge_maker(judge))
            await score_again(log, judge, lent, repeats=wish.repeats, more=False, at_a_time=AT_A_TIME)
            evaluation = read_evaluation(log)
    made = [judgement for judgement in requested_judgements(evaluation.trials, name, wish.repeats) if judgement is not None]
    return Ended(evaluation, name, JudgementTally.of(made))
