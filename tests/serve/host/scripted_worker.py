"""A deliberate fake of a worker: it offers runs whose tools do nothing, so that tests of the host need no engine."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from scope_ptz.bench.agents.faults import agent_failure
from scope_ptz.bench.agents.messages import (
    CallResult,
    Calls,
    CameraLimits,
    CameraPose,
    Error,
    Hello,
    HostMessage,
    Reply,
    Results,
    TaskMessage,
    View,
)
from scope_ptz.errors import PlannerError
from scope_ptz.serve.bench_host.channel import HostedChannel
from scope_ptz.serve.bench_host.links import RunWorker, WorkerSide
from scope_ptz.serve.bench_host.wire import Begin, Finished, Ready, RunOffered, WorkerSettings
from scope_ptz.tools.registry import schemas

LIMITS = CameraLimits(
    min_pan_deg=-180, max_pan_deg=180, min_tilt_deg=-90, max_tilt_deg=20, min_zoom=1, max_zoom=5, pan_endless=True
)  # fmt: skip


class ScriptedWorker:
    """Offers runs one after another, and records what agents send in them."""

    def __init__(self, runs: int, *, step_s: float = 60.0, crash_in: Callable[[str], bool] = lambda _: False) -> None:
        self.runs, self.step_s, self.crash_in = runs, step_s, crash_in
        self.log: dict[str, list[str]] = {}
        """The types of the messages in each run, by participant and run; faults of the agent at the end."""

    @property
    def worker(self) -> RunWorker:
        return self._run

    async def _run(self, link: WorkerSide, settings: WorkerSettings) -> None:
        await link.send(Ready(runs=self.runs))
        if settings.check_only:
            return
        for number in range(self.runs):
            run = f"{settings.participant}-{number}"
            channel = HostedChannel(run, link.send)
            await link.send(RunOffered(run=run))
            listening = asyncio.ensure_future(_listen(link, channel))
            attempt = asyncio.ensure_future(self._attempt(channel, number))
            await asyncio.wait({listening, attempt}, return_when=asyncio.FIRST_COMPLETED)
            goes_on = attempt.done() and attempt.result()
            listening.cancel()
            attempt.cancel()
            await asyncio.gather(listening, attempt, return_exceptions=True)
            if not goes_on:
                return
        settings.folder.mkdir(parents=True, exist_ok=True)
        submission = settings.folder / "submission.jsonl"
        submission.write_text("{}\n", "utf-8")
        await link.send(Finished(submission=submission))

    async def _attempt(self, channel: HostedChannel, number: int) -> bool:
        """Carry out a run. Return False if the worker is to crash."""
        log = self.log[channel.run] = []
        try:
            while True:
                try:
                    async with asyncio.timeout(self.step_s if log else None):  # time counts from the first message
                        message = await channel.receive()
                except TimeoutError:
                    raise agent_failure("agent-timeout", "The agent took too long.") from None
                log.append(message.type)
                if self.crash_in(f"{channel.run}/{len(log)}"):
                    return False
                if isinstance(message, Reply):
                    break
                await channel.send(self._answer(message, number))
        except PlannerError as error:
            log.append(str(error.kind))
            if error.kind != "agent-exited":
                await channel.send(Error(message=str(error)))
        await channel.close("The run has ended.")
        return True

    def _answer(self, message: object, number: int) -> HostMessage:
        if isinstance(message, Hello):
            return TaskMessage(
                task=f"handle-{number}", instruction=f"instruction {number}", tools=tuple(schemas()), presets=("yard",),
                limits=LIMITS, pose=CameraPose(pan_deg=0, tilt_deg=0, zoom=1),
            )  # fmt: skip
        if isinstance(message, Calls):
            return Results(results=tuple(CallResult(id=c.id, result={"message": f"{c.name} is done."}) for c in message.calls))
        return View(media_type="image/jpeg", data="/9j/")


async def _listen(link: WorkerSide, channel: HostedChannel) -> None:
    while (command := await link.receive()) is not None:
        if command.run == channel.run and not isinstance(command, Begin):
            channel.accept(command)
