"""An evaluation in progress, which runs the missing trials, requests the missing judgements, and writes the log."""

from __future__ import annotations

import gc
import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import anyio

from scope_ptz.bench.engine.context import Watcher
from scope_ptz.builtin_names import BUILT_IN_PERCEPTION, GRAMMAR
from scope_ptz.errors import InputError, ScopeError
from scope_ptz.factory.evaluation_options import (
    BUILT_IN_AGENT,
    EvaluationOptions,
    EvaluationPlan,
    EvaluationProgress,
    EvaluationResult,
    JudgeSettings,
)
from scope_ptz.factory.models import ResolvedPair
from scope_ptz.factory.rescore import complete_judgements, judge_model, open_requested_judge, with_judge

if TYPE_CHECKING:
    from scope_ptz.bench.engine.benchmark_task import Task
    from scope_ptz.bench.engine.entries import Entry
    from scope_ptz.bench.engine.runs import EngineSetup, StoredLog
    from scope_ptz.bench.judging.server import JudgeServer
    from scope_ptz.bench.scoring.trials import Trial
    from scope_ptz.planner.base import Planner

DEFAULT_CONCURRENCY_WITH_SERVERS = 8
"""Default number of concurrent runs if a model server or an external agent is used."""
PERCEPTION_CALLS_PER_STEP = 8
"""Maximum number of concurrent perception calls in one step of the agent loop."""
MAX_CONSECUTIVE_FAILURES = 12
"""Number of consecutive runs with infrastructure failures after which an evaluation stops."""
GC_THRESHOLDS = (20_000, 20, 50)
"""Arguments for ``gc.set_threshold`` during an evaluation. They are far above the defaults, so that collections are rare."""


class EvaluationSession:
    """The tasks, models and connections of one call to ``evaluate``. ``close`` closes the connections."""

    def __init__(self, options: EvaluationOptions, pair: ResolvedPair, progress: EvaluationProgress) -> None:
        from scope_ptz.bench.engine.entries import digest, select_entries
        from scope_ptz.bench.engine.runs import identity_of
        from scope_ptz.factory.evaluation import eval_context, evaluation_planner
        from scope_ptz.factory.external_agents import external_agent

        self.options, self.pair, self.progress = options, pair, progress
        self.judge: JudgeServer | None = None
        self.agent = options.hosted_agent or external_agent(options)
        self.agent_name = self.agent.name if self.agent is not None else BUILT_IN_AGENT
        self.agent_source = self.agent.source if self.agent is not None else ""
        self.planner = evaluation_planner(pair.planner) if self.agent is None else None
        self.context = eval_context(seed=options.seed, planner=self.planner, perception=pair.perception, pictures=options.pictures)
        self.entries: tuple[Entry, ...] = select_entries(
            self.context.load_tasks(options.tasks), options.categories, options.scenes, options.limit
        )
        _check_pictures(options, pair, self.planner)
        local = pair.planner.endpoint is None and pair.perception.spec is None and self.agent is None
        # Without servers, runs compete for the interpreter, so concurrency would use more memory without saving time.
        default = 1 if local else DEFAULT_CONCURRENCY_WITH_SERVERS
        self.concurrency = 1 if options.latency else options.concurrency or default
        details = self.planner.details if self.planner is not None else {}
        spec = pair.perception.spec
        self.identity = identity_of(
            digest(self.entries), options.epochs, options.seed, self.agent_name, options.max_steps, options.time_s,
            options.pictures, options.latency, options.variant, pair.planner.name, pair.perception.name,
            {name: value for name, value in details.items() if name != "url"},
            spec.model_dump(mode="json", exclude={"endpoint"}) if spec else None, _served_models(pair), self.agent_source,
            *([self.agent.settings] if self.agent is not None and self.agent.settings else []),
        )  # fmt: skip

    async def close(self) -> None:
        """Close the planner, the perception backend and the judge."""
        for resource in (self.planner, self.context.perception, self.judge):
            if resource is not None:
                await resource.close()

    async def stored_logs(self) -> list[StoredLog]:
        """Return the logs from which this evaluation can be resumed, the most complete first."""
        from scope_ptz.bench.engine.runs import find_logs, read_stored_log

        if self.options.resume is not None:
            log = read_stored_log(self.options.resume)
            if (log.header.eval.metadata or {}).get("identity") != self.identity:
                raise InputError(
                    f"{log.path} is the log of another evaluation, with different tasks, models or settings. "
                    "Use the options of that evaluation."
                )
            return [log]
        return [] if self.options.fresh else await find_logs(self.options.out, self.identity)

    async def run(self, stored: Sequence[StoredLog]) -> Path:
        """Run the trials that are missing from the stored logs, and return the path of the complete log.

        Raises:
            ScopeError: Too many consecutive runs had infrastructure failures.
        """
        from scope_ptz.bench.engine.failure_summary import failure_summary
        from scope_ptz.bench.engine.logs import read_evaluation
        from scope_ptz.bench.engine.runs import run

        finished = tuple(t for t in read_evaluation(stored[0].path).trials if t.headline != "infrastructure") if stored else ()
        plan = self._plan(finished, stored)
        if self.agent is not None:
            await self.agent.check()
        judge = self.judge = await open_requested_judge(self.options.judge) if self.options.judge is not None else None
        setup = await self._engine_setup(judge)
        group = anyio.create_task_group()
        breaker = _CircuitBreaker(self.progress, group.cancel_scope.cancel)
        task = self._task(breaker, judge)
        outcome: list[Path | ScopeError] = []

        async def work() -> None:
            try:
                outcome.append(await run(task, setup, stored))
            except ScopeError as error:
                outcome.append(error)

        self.progress.planned(plan)
        try:
            # The engine catches cancellation. Run it in a separate task, so that the current task does not count as cancelled.
            with reduced_garbage_collection():
                async with group:
                    group.start_soon(work)
        finally:
            self.progress.closed()
        if breaker.tripped:
            causes = "".join(f" {line[0].upper()}{line[1:]}" for line in failure_summary([*finished, *breaker.trials], setup.card))
            raise ScopeError(
                f"The evaluation stopped after {MAX_CONSECUTIVE_FAILURES} consecutive runs with infrastructure failures."
                f"{causes} Check the servers, and run the same command again to resume the evaluation."
            )
        (result,) = outcome
        if isinstance(result, ScopeError):
            raise result
        return result

    async def with_judgements(self, log: Path, *, retry_failed: bool) -> EvaluationResult:
        """Request the missing judgements for a log, and return the updated results.

        Args:
            log: The evaluation log.
            retry_failed: Whether to repeat judgements for which the judge's server failed.
        """
        from scope_ptz.bench.engine.logs import read_evaluation

        judge = self.options.judge
        if judge is None:
            return EvaluationResult(read_evaluation(log))
        return await complete_judgements(
            log, judge, lambda: self._connect_judge(judge), self.context, retry_failed=retry_failed, notify=self.progress.note
        )

    async def _connect_judge(self, settings: JudgeSettings) -> JudgeServer:
        """Return the connection to the judge, which is opened on first use."""
        if self.judge is None:
            self.judge = await open_requested_judge(settings)
        return self.judge

    def _task(self, watcher: Watcher, judge: JudgeServer | None) -> Task:
        from scope_ptz.bench.engine.benchmark_task import benchmark_task

        options = self.options
        open_agent = self.agent.open if self.agent is not None else None
        order = options.hosted_agent.order if options.hosted_agent is not None else None
        context = replace(self.context, watcher=watcher, load_tasks=lambda _: self.entries, open_agent=open_agent, order=order)
        if judge is not None:
            context = with_judge(context, judge)
        return benchmark_task(lambda _: context)(
            split=options.tasks, category=list(options.categories) or None, scene=list(options.scenes) or None,
            limit=options.limit, agent=self.agent_name, pictures=options.pictures, max_steps=options.max_steps,
            time_s=options.time_s, seed=options.seed, epochs=options.epochs,
            judgements=options.judge.repeats if options.judge else 0,
        )  # fmt: skip

    async def _engine_setup(self, judge: JudgeServer | None) -> EngineSetup:
        from scope_ptz.bench.engine.recording.scope_model import inspect_model
        from scope_ptz.bench.engine.runs import EngineSetup
        from scope_ptz.factory.run_card import run_card

        options, pair = self.options, self.pair
        card = await run_card(
            pair, self.planner, self.entries, agent=self.agent_name, agent_source=self.agent_source,
            isolation=self.agent.isolation if self.agent is not None else None,
            concurrency=self.concurrency, contended=not options.latency, variant=options.variant, price=options.price,
            split=Path(options.tasks).name, seed=options.seed, max_steps=options.max_steps, epochs=options.epochs,
        )  # fmt: skip
        connections = self.concurrency * PERCEPTION_CALLS_PER_STEP
        endpoint, spec = pair.planner.endpoint, pair.perception.spec
        planner = None
        if self.planner is not None:
            served = endpoint.model if endpoint else None
            planner = inspect_model(pair.planner.name, connections, url=endpoint.url if endpoint else None, served=served)
        url = spec.endpoint.url if spec is not None and spec.endpoint is not None else None
        perception = inspect_model(pair.perception.name, connections, url=url)
        judging = judge_model(judge, self.concurrency * 2) if judge is not None else None
        return EngineSetup(
            options.out, planner, perception, judging, self.concurrency, self.identity, card,
            realtime=options.hosted_agent is not None or not _is_built_in(pair),
        )  # fmt: skip

    def _plan(self, finished: tuple[Trial, ...], stored: Sequence[StoredLog]) -> EvaluationPlan:
        from scope_ptz.bench.engine.entries import digest
        from scope_ptz.bench.engine.estimate import estimate
        from scope_ptz.bench.engine.runs import earlier_evaluations, log_with_other_source

        options, pair = self.options, self.pair
        agent = self.agent.name if self.agent is not None else None
        runs, origin = len(self.entries) * options.epochs, ""
        if stored:
            origin = f"Resuming {stored[0].path}: {len(finished)} of {runs} runs are finished."
        elif agent:
            other = log_with_other_source(options.out, agent, self.agent_source, digest(self.entries))
            if other is not None:
                origin = f"The source code of {agent} differs from that in {other}, so this is a new evaluation."
        earlier = earlier_evaluations(options.out, agent or pair.planner.name, pair.perception.name)
        finished_ids = {trial.task.id for trial in finished} if options.epochs == 1 else set()
        remaining = [entry for entry in self.entries if entry.facts.id not in finished_ids]
        expected = estimate(remaining, options.epochs, self.concurrency, earlier, options.price, prompt_chars(self.planner))
        return EvaluationPlan(
            runs, pair.planner.name, pair.perception.name, agent, self.concurrency, finished, expected,
            pair.planner.endpoint is not None, self.agent.isolation if self.agent is not None else None, origin,
        )  # fmt: skip


class _CircuitBreaker(Watcher):
    """Forwards runs to a watcher, and stops the evaluation after too many consecutive infrastructure failures."""

    def __init__(self, watcher: Watcher, stop: Callable[[], None]) -> None:
        self._watcher, self._stop = watcher, stop
        self._consecutive_failures = 0
        self.trials: list[Trial] = []
        self.tripped = False

    def run_began(self, sample: str, entry: Entry) -> None:
        self._watcher.run_began(sample, entry)

    def run_ended(self, sample: str, trial: Trial) -> None:
        self.trials.append(trial)
        self._watcher.run_ended(sample, trial)
        self._consecutive_failures = self._consecutive_failures + 1 if trial.headline == "infrastructure" else 0
        if self._consecutive_failures >= MAX_CONSECUTIVE_FAILURES and not self.tripped:
            self.tripped = True
            self._stop()


@contextmanager
def reduced_garbage_collection() -> Iterator[None]:
    """Run the garbage collector less often inside the block, and exclude existing objects from collection.

    Scenes and tasks consist of many small objects, and scanning them repeatedly would take a tenth of an evaluation's time. If the
    program has already called ``gc.freeze``, existing objects are not excluded, because ``gc.unfreeze`` at the end of the block
    would also unfreeze the program's objects.
    """
    thresholds, can_freeze = gc.get_threshold(), gc.get_freeze_count() == 0
    gc.collect()
    if can_freeze:
        gc.freeze()
    gc.set_threshold(*GC_THRESHOLDS)
    try:
        yield
    finally:
        gc.set_threshold(*thresholds)
        if can_freeze:
            gc.unfreeze()


def prompt_chars(planner: Planner | None) -> int | None:
    """Return the number of characters in a planner's prompt and tool schemas.

    Return None for a planner without a prompt, and for a planner that receives pictures, which make up most of its tokens.
    """
    from scope_ptz.planner.chat.prompts import Prompt
    from scope_ptz.tools.registry import schemas

    prompt = getattr(planner, "prompt", None)
    if planner is None or planner.sees or not isinstance(prompt, Prompt):
        return None
    return len(prompt.text) + len(json.dumps(list(schemas())))


def _check_pictures(options: EvaluationOptions, pair: ResolvedPair, planner: Planner | None) -> None:
    """Raise ``InputError`` if pictures are disabled but a model requires them."""
    if options.pictures:
        return
    if pair.perception.spec is not None:
        raise InputError(f"The perception backend '{pair.perception.name}' requires pictures. Remove --no-pictures.")
    if planner is not None and planner.sees:
        raise InputError(f"The planner '{planner.name}' requires pictures. Remove --no-pictures.")


def _is_built_in(pair: ResolvedPair) -> bool:
    """Return whether the planner and the perception backend are built in.

    Such runs are cheap, so an interrupted evaluation may lose some of them and repeat them when it is resumed.
    """
    planner, perception = pair.planner, pair.perception
    return (
        planner.name == GRAMMAR
        and perception.name in BUILT_IN_PERCEPTION
        and planner.instance is None
        and perception.instance is None
    )


def _served_models(pair: ResolvedPair) -> list[str]:
    """Return the served model names, which are part of an evaluation's identity. URLs are not, because they may change."""
    spec = pair.perception.spec
    perception = spec.endpoint.model if spec is not None and spec.endpoint is not None else ""
    return [pair.planner.endpoint.model if pair.planner.endpoint else "", perception]
