"""One evaluation from options to its log: choose, estimate, run or go on, tell."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import anyio

from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.cli.bench_judged import Ended, JudgeOptions, judged, open_wished
from scope_ptz.cli.endings import complain
from scope_ptz.errors import ConfigError, InputError, ScopeError
from scope_ptz.factory.models import ModelOptions, ResolvedPair, resolve_models

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.console import Console

    from scope_ptz.bench.engine.entries import Entry
    from scope_ptz.bench.engine.estimate import Price
    from scope_ptz.bench.engine.runs import Found, Setting
    from scope_ptz.bench.judging.server import JudgeServer
    from scope_ptz.planner.base import Planner

OWN_AGENT = "scope"
WITH_MODELS = 8
"""Runs at a time when a model server answers."""


@dataclass(frozen=True, slots=True)
class RunOptions:
    """The options of `scope bench run`, as they were typed. ``concurrency``: None for what suits the models."""

    wishes: ModelOptions
    out: Path
    tasks: str = "core"
    categories: tuple[str, ...] = ()
    scenes: tuple[str, ...] = ()
    limit: int | None = None
    epochs: int = 1
    seed: int = 1
    agent: str = OWN_AGENT
    max_steps: int = 60
    time_s: float | None = None
    concurrency: int | None = None
    latency: bool = False
    pictures: bool = True
    variant: str = ""
    fresh: bool = False
    resume: Path | None = None
    price: Price | None = None
    judge: JudgeOptions | None = None


def need_engine() -> None:
    """Raises ``ConfigError`` when the evaluation engine is not installed."""
    from importlib.util import find_spec

    if find_spec("inspect_ai") is None:
        raise ConfigError("Evaluations need Inspect AI. Install it with: pip install 'scope-ptz[bench]'")


async def evaluate(options: RunOptions, console: Console) -> Ended:
    """Run an evaluation, or go on with it, or just read it when it is done; judge what was not judged yet."""
    from scope_ptz.bench.engine.runs import alone

    choice = await resolve_models(options.wishes)
    prepared = _Prepared(options, choice)
    with alone(options.out, prepared.identity):
        before = await prepared.before()
        try:
            if before and before[0].finished:
                complain(f"this evaluation is done: {before[0].path} (--fresh runs it again)")
                return await prepared.judged(before[0].path, again=True)
            return await prepared.judged(await prepared.run(console, before), again=False)
        finally:
            with anyio.CancelScope(shield=True):
                await prepared.close()


class _Prepared:
    """An evaluation that has its tasks and its models, and has not begun."""

    def __init__(self, options: RunOptions, choice: ResolvedPair) -> None:
        from scope_ptz.bench.engine.entries import chosen, digest
        from scope_ptz.bench.engine.external_agents import source_digest
        from scope_ptz.bench.engine.runs import identity_of
        from scope_ptz.factory.evaluation import eval_context, planner_for

        self.options, self.choice = options, choice
        self.agent_source = source_digest(options.agent) if options.agent != OWN_AGENT else ""
        self.judge: JudgeServer | None = None
        self.planner = planner_for(choice.planner) if options.agent == OWN_AGENT else None
        self.lent = eval_context(seed=options.seed, planner=self.planner, perception=choice.perception)
        self.entries: tuple[Entry, ...] = chosen(
            self.lent.load_tasks(options.tasks), options.categories, options.scenes, options.limit
        )
        if not options.pictures and choice.perception.spec is not None:
            raise InputError(f"The eyes '{choice.perception.name}' look at pictures: leave --no-pictures out.")
        if not options.pictures and self.planner is not None and self.planner.sees:
            raise InputError(f"The planner '{self.planner.name}' looks at pictures: leave --no-pictures out.")
        calm = choice.planner.endpoint is None and choice.perception.spec is None and options.agent == OWN_AGENT
        self.concurrency = 1 if options.latency else options.concurrency or ((os.cpu_count() or 1) if calm else WITH_MODELS)
        details = self.planner.details if self.planner is not None else {}
        spec = choice.perception.spec
        self.identity = identity_of(
            digest(self.entries), options.epochs, options.seed, options.agent, options.max_steps, options.time_s,
            options.pictures, options.latency, options.variant, choice.planner.name, choice.perception.name,
            {name: value for name, value in details.items() if name != "url"},
            spec.model_dump(mode="json", exclude={"endpoint"}) if spec else None, _place(choice), self.agent_source,
        )  # fmt: skip

    async def close(self) -> None:
        """Release what models hold."""
        for held in (self.planner, self.lent.eyes, self.judge):
            if held is not None:
                await held.close()

    async def before(self) -> list[Found]:
        """The logs to go on with, the one that got furthest first."""
        from scope_ptz.bench.engine.runs import find, found

        if self.options.resume is not None:
            log = found(self.options.resume)
            if (log.header.eval.metadata or {}).get("identity") != self.identity:
                raise InputError(f"{log.path} is of another evaluation: tasks, models or settings differ. Give its own options.")
            return [log]
        return [] if self.options.fresh else await find(self.options.out, self.identity)

    async def run(self, console: Console, before: Sequence[Found]) -> Path:
        from scope_ptz.bench.engine.context import EQUIPMENT
        from scope_ptz.bench.engine.logs import read_evaluation
        from scope_ptz.bench.engine.runs import run
        from scope_ptz.cli.bench_live import LiveTable
        from scope_ptz.cli.bench_troubles import troubles
        from scope_ptz.factory.evaluation import judge_maker
        from scope_ptz.factory.inspect_plugin import bench

        done = tuple(t for t in read_evaluation(before[0].path).trials if t.headline != "infrastructure") if before else ()
        wanted = len(self.entries) * self.options.epochs
        self._foretell(console, wanted, done, before)
        judge = self.judge = await open_wished(self.options.judge) if self.options.judge is not None else None
        setting = await self._setting(judge)
        group = anyio.create_task_group()
        with LiveTable(console, wanted, done, setting.card.pair, lambda: group.cancel_scope.cancel()) as table:
            lent = self.lent if judge is None else replace(self.lent, make_judge=judge_maker(judge))
            EQUIPMENT.set(replace(lent, watcher=table, load_tasks=lambda _: self.entries))
            options = self.options
            task = bench(
                split=options.tasks, category=list(options.categories) or None, scene=list(options.scenes) or None,
                limit=options.limit, agent=options.agent, pictures=options.pictures, max_steps=options.max_steps,
                time_s=options.time_s, seed=options.seed, epochs=options.epochs,
                judgements=options.judge.repeats if options.judge else 0,
            )  # fmt: skip
            came: list[Path | ScopeError] = []

            async def work() -> None:
                try:
                    came.append(await run(task, setting, before))
                except ScopeError as error:
                    came.append(error)

            # In a task of its own: the engine takes a cancellation for its own affair, and this one stays clean of it.
            async with group:
                group.start_soon(work)
        if table.stopped:
            why = "".join(f" {line[0].upper()}{line[1:]}" for line in troubles(table.trials, setting.card))
            raise ScopeError(
                f"Too many runs in a row were broken by infrastructure, so the evaluation stopped.{why} Look after the servers; "
                "the same command goes on where it stopped."
            )
        if isinstance(came[0], ScopeError):
            raise came[0]
        return came[0]

    async def judged(self, log: Path, *, again: bool) -> Ended:
        """The log as it stands, when it was judged as wished; ``again``: also where the judge's server had failed."""
        from scope_ptz.bench.engine.logs import read_evaluation

        wish = self.options.judge
        if wish is None:
            return Ended(read_evaluation(log))

        async def opened() -> JudgeServer:
            self.judge = self.judge or await open_wished(wish)
            return self.judge

        return await judged(log, wish, opened, self.lent, again=again)

    async def _setting(self, judge: JudgeServer | None) -> Setting:
        from inspect_ai.model import GenerateConfig, get_model

        import scope_ptz.factory.inspect_plugin  # noqa: F401 - the models of this project
        from scope_ptz.bench.engine.runs import Setting
        from scope_ptz.factory.judge_role import judge_as_model
        from scope_ptz.factory.run_card import run_card

        options, choice = self.options, self.choice
        card = await run_card(
            choice, self.planner, self.entries, agent=options.agent, agent_source=self.agent_source,
            concurrency=self.concurrency, contended=not options.latency, variant=options.variant, price=options.price,
            split=Path(options.tasks).name, seed=options.seed, max_steps=options.max_steps, epochs=options.epochs,
        )  # fmt: skip
        # Looks of one step are made at the same time, as many as the loop allows.
        config = GenerateConfig(max_connections=self.concurrency * 8)
        endpoint, spec = choice.planner.endpoint, choice.perception.spec
        planner = None
        if self.planner is not None:
            planner = get_model(
                f"scope_ptz/{choice.planner.name}",
                base_url=endpoint.url if endpoint else None,
                config=config,
                memoize=False,
                served=endpoint.model if endpoint else None,
            )
        url = spec.endpoint.url if spec is not None and spec.endpoint is not None else None
        eyes = get_model(f"scope_ptz/{choice.perception.name}", base_url=url, config=config, memoize=False)
        judging = judge_as_model(judge, self.concurrency * 2) if judge is not None else None
        return Setting(options.out, planner, eyes, judging, self.concurrency, self.identity, card)

    def _of_other_source(self, agent: str) -> Path | None:
        from scope_ptz.bench.engine.entries import digest
        from scope_ptz.bench.engine.runs import of_other_source

        return of_other_source(self.options.out, agent, self.agent_source, digest(self.entries))

    def _foretell(self, console: Console, wanted: int, done: Sequence[Trial], before: Sequence[Found]) -> None:
        from scope_ptz.bench.engine.estimate import estimate
        from scope_ptz.bench.engine.runs import earlier
        from scope_ptz.cli.bench_foretelling import lines

        agent = self.options.agent if self.options.agent != OWN_AGENT else None

        if before:
            console.print(
                f"Going on with {before[0].path}: {len(done)} of {wanted} runs are done.", highlight=False, soft_wrap=True
            )
        elif agent and (other := self._of_other_source(agent)) is not None:
            console.print(
                f"The source of {agent} is not that of {other}: this is a new evaluation.", highlight=False, soft_wrap=True
            )
        known = earlier(self.options.out, agent or self.choice.planner.name, self.choice.perception.name)
        kept = {trial.task.id for trial in done} if self.options.epochs == 1 else set()
        left = [entry for entry in self.entries if entry.facts.id not in kept]
        told = estimate(left, self.options.epochs, self.concurrency, known, self.options.price, opening_chars(self.planner))
        for line in lines(told, self.choice, self.concurrency, agent):
            console.print(line, highlight=False, soft_wrap=True)


def opening_chars(planner: Planner | None) -> int | None:
    """How long prompt and tools of a model are; None for a planner without a prompt, or one whose pictures would weigh more."""
    from scope_ptz.planner.chat.prompts import Prompt
    from scope_ptz.tools.registry import schemas

    prompt = getattr(planner, "prompt", None)
    if planner is None or planner.sees or not isinstance(prompt, Prompt):
        return None
    return len(prompt.text) + len(json.dumps(list(schemas())))


def _place(choice: ResolvedPair) -> list[str]:
    """Which served models are asked. Where a server listens may change between a run and its continuation."""
    spec = choice.perception.spec
    eyes = spec.endpoint.model if spec is not None and spec.endpoint is not None else ""
    return [choice.planner.endpoint.model if choice.planner.endpoint else "", eyes]
