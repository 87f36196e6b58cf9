"""The Inspect AI plug-in: the task ``scope_ptz/bench``, its scorers, and the models ``scope_ptz/...``.

Example::

    inspect eval scope_ptz/bench --model-role planner=scope_ptz/grammar --model-role eyes=scope_ptz/ground-truth -T limit=5
"""

from __future__ import annotations

from inspect_ai.scorer import Scorer, scorer
from inspect_ai.solver import Solver, solver

from scope_ptz.bench.engine.agent_solver import BUILT_IN_AGENT, agent_solver
from scope_ptz.bench.engine.benchmark_task import benchmark_task
from scope_ptz.bench.engine.checks_scorer import CHECKS, METRICS, checks_scorer
from scope_ptz.bench.engine.judge_scorer import judge_scorer
from scope_ptz.bench.engine.judgement_scores import JUDGE
from scope_ptz.bench.engine.recording.scope_model import scope_ptz
from scope_ptz.factory.evaluation import eval_context

__all__ = ["bench", "checks", "judge", "scope_agent", "scope_ptz"]

bench = benchmark_task(lambda seed: eval_context(seed=seed))
"""The benchmark task, whose context is created from the settings."""


@solver
def scope_agent(
    agent: str = BUILT_IN_AGENT, pictures: bool = True, max_steps: int = 60, time_s: float | None = None, seed: int = 1
) -> Solver:
    """The agent as a solver, under the name stored in logs. The parameters are those of ``bench``."""
    context = eval_context(seed=seed)
    return agent_solver(context, agent=agent, pictures=pictures, max_steps=max_steps, time_s=time_s, seed=seed)


@scorer(metrics=list(METRICS), name=CHECKS)
def checks() -> Scorer:
    """The executable checks as a scorer, for ``inspect score``."""
    return checks_scorer()


@scorer(metrics=list(METRICS), name=JUDGE)
def judge(repeat: int = 0) -> Scorer:
    """The judge as a scorer, for ``inspect score --model-role judge=...``. ``repeat`` is the index of the judgement."""
    return judge_scorer(eval_context(seed=1), repeat)
