"""The worker process, which runs one participant's evaluation and signs the submission.

Only this process holds the tasks and the signing key.
"""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import os
import random
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.errors import InputError, ScopeError
from scope_ptz.factory.evaluation_options import EvaluationOptions, EvaluationProgress, HostedAgent
from scope_ptz.serve.bench_host.channel import HostedChannel
from scope_ptz.serve.bench_host.links import StandardStreams, WorkerSide
from scope_ptz.serve.bench_host.wire import (
    MAX_LINE_BYTES,
    Begin,
    Failed,
    Finished,
    Ready,
    RunOffered,
    WorkerSettings,
)

if TYPE_CHECKING:
    from scope_ptz.bench.agents.planner import ChannelPlanner
    from scope_ptz.bench.engine.entries import Entry

SUBMISSION_FILE = "submission.jsonl"
RUN_KEY_CHARS = 16
LOCK_ATTEMPTS, LOCK_PAUSE_S = 20, 1.0  # an evaluation may still be locked by a killed host's worker


class Worker:
    """Runs one participant's evaluation.

    Args:
        link: The link to the host.
        settings: The worker's settings.

    Attributes:
        sample: Name of the running sample. Samples run one after the other.
    """

    def __init__(self, link: WorkerSide, settings: WorkerSettings) -> None:
        self._link, self._settings = link, settings
        self._channel: HostedChannel | None = None
        self._begin = asyncio.Event()
        self.sample = ""

    async def run(self) -> None:
        """Run the evaluation until it is finished or the host disconnects. Errors are reported to the host."""
        work = asyncio.ensure_future(self._work())
        listening = asyncio.ensure_future(self._listen())
        try:
            await asyncio.wait({work, listening}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in (work, listening):
                task.cancel()
            await asyncio.gather(work, listening, return_exceptions=True)

    async def _listen(self) -> None:
        """Forward the host's commands to the channel until the host disconnects."""
        while (command := await self._link.receive()) is not None:
            if self._channel is None or command.run != self._channel.run:
                continue  # a message for a run that has ended in the meantime
            if isinstance(command, Begin):
                self._begin.set()
            else:
                self._channel.accept(command)

    async def _work(self) -> None:
        try:
            await self._evaluate()
        except ScopeError as error:
            await self._link.send(Failed(message=str(error)))
        except Exception as error:  # a bug; the host restarts the worker, and the host's log shows the error
            await self._link.send(Failed(message=f"{type(error).__name__}: {error}"))

    async def _evaluate(self) -> None:
        from scope_ptz.bench.signatures.detached import sign
        from scope_ptz.bench.signatures.keys import load_private_key

        settings = self._settings
        key = load_private_key(settings.key)
        options = evaluation_options(settings)
        await self._link.send(Ready(runs=await _number_of_runs(options)))
        if settings.check_only:
            return
        log = await self._run_engine(options)
        submission = await asyncio.to_thread(_write_submission, log, settings.folder / SUBMISSION_FILE)
        sign(submission, key)
        await self._link.send(Finished(submission=submission))

    async def _run_engine(self, options: EvaluationOptions) -> Path:
        """Run the engine, and return the path of the log."""
        from scope_ptz.factory.evaluate import evaluate

        times = {"step_s": self._settings.evaluation.step_s, "run_s": self._settings.evaluation.task_s}
        agent = HostedAgent(self._settings.participant, self._open_agent, self._order, times)
        options = replace(options, hosted_agent=agent)
        for attempt in range(LOCK_ATTEMPTS):
            try:
                return Path((await evaluate(options, progress=_RunningSample(self))).evaluation.log)
            except InputError as error:
                if "already running" not in str(error) or attempt == LOCK_ATTEMPTS - 1:
                    raise
                await asyncio.sleep(LOCK_PAUSE_S)
        raise AssertionError("unreachable")

    async def _open_agent(self) -> ChannelPlanner:
        """Offer a run to the agent, and connect it when it begins the run."""
        from scope_ptz.bench.agents.planner import AgentTimeLimits, ChannelPlanner

        settings = self._settings
        self._begin.clear()
        self._channel = HostedChannel(self._run_key(self.sample), self._link.send)
        await self._link.send(RunOffered(run=self._channel.run))
        await self._begin.wait()
        times = AgentTimeLimits(step_s=settings.evaluation.step_s, run_s=settings.evaluation.task_s)
        planner = ChannelPlanner(self._channel, settings.participant, times)
        await planner.connect()
        return planner

    def _run_key(self, sample: str) -> str:
        digest = hmac.new(self._settings.order_seed.encode(), f"run\0{sample}".encode(), hashlib.sha256)
        return digest.hexdigest()[:RUN_KEY_CHARS]

    def _order(self, entries: Sequence[Entry]) -> list[Entry]:
        """Return the tasks in the participant's order, which depends only on the secret seed and the tasks."""
        ordered = sorted(entries, key=lambda entry: entry.facts.id)
        random.Random(f"{self._settings.order_seed}:order").shuffle(ordered)
        return ordered


class _RunningSample(EvaluationProgress):
    """Records in the worker which sample is running."""

    def __init__(self, worker: Worker) -> None:
        self._worker = worker

    def run_began(self, sample: str, entry: Entry) -> None:  # noqa: ARG002 - the signature of the base class
        self._worker.sample = sample


async def run_worker(link: WorkerSide, settings: WorkerSettings) -> None:
    """Run one participant's evaluation. This function is a ``links.RunWorker``."""
    await Worker(link, settings).run()


def evaluation_options(settings: WorkerSettings) -> EvaluationOptions:
    """Return the engine's options for evaluating a participant."""
    from scope_ptz.factory.models import ModelOptions

    evaluation = settings.evaluation
    return EvaluationOptions(
        models=ModelOptions(**evaluation.perception.model_dump()),
        out=settings.folder,
        tasks=evaluation.tasks,
        epochs=evaluation.epochs,
        seed=evaluation.seed,
        max_steps=evaluation.max_steps,
        concurrency=1,
    )


async def _number_of_runs(options: EvaluationOptions) -> int:
    """Check that an evaluation's tasks and perception can be opened, and return its number of runs."""
    from scope_ptz.factory.evaluation import load_entries
    from scope_ptz.factory.models import resolve_models
    from scope_ptz.factory.scenes import scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.library import Library

    await resolve_models(options.models)
    entries = await asyncio.to_thread(load_entries, options.tasks, Library(scene_search(load_settings())))
    if any(entry.task is None for entry in entries):
        raise InputError("Hosted tasks must have executable checks, but some tasks in this file can only be scored by a judge.")
    return len(entries) * options.epochs


def _write_submission(log: Path, out: Path) -> Path:
    from scope_ptz.bench.engine.logs import read_evaluation
    from scope_ptz.bench.engine.traces.log_runs import read_runs
    from scope_ptz.bench.submissions.submission import submission_lines, write_submission
    from scope_ptz.bench.submissions.submission_traces import publish_runs

    published = publish_runs(read_evaluation(log), read_runs(log))
    header, lines = submission_lines(published.evaluation, published.runs, published.places)
    write_submission((header.model_copy(update={"evaluated": "hosted"}), lines), out)
    return out


async def _main() -> None:
    output = os.dup(1)
    os.dup2(2, 1)  # output from libraries must not reach the host as events
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader(limit=MAX_LINE_BYTES)
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), sys.stdin)

    def write(line: bytes) -> None:
        view = memoryview(line)
        while view:
            view = view[os.write(output, view) :]

    settings = WorkerSettings.model_validate_json(await reader.readline())
    try:
        await run_worker(StandardStreams(reader, write), settings)
    except BrokenPipeError:
        return  # the host has disconnected


if __name__ == "__main__":
    asyncio.run(_main())
