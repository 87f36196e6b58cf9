"""The Inspect solver that runs the agent loop on a sample, and stores the run in the sample."""

from __future__ import annotations

from inspect_ai.model import ModelOutput, get_model
from inspect_ai.solver import Generate, Solver, TaskState, solver

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Budgets, RunLabels, RunResult
from scope_ptz.agent.store import NoImages
from scope_ptz.bench.agents.launch import AgentOptions
from scope_ptz.bench.agents.planner import ChannelPlanner
from scope_ptz.bench.agents.start import local_agent
from scope_ptz.bench.engine.context import EvalContext
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.inspect_internals import attachment_reference
from scope_ptz.bench.engine.recording.logged_perception import LoggedPerception
from scope_ptz.bench.engine.recording.logged_planner import LoggedPlanner
from scope_ptz.bench.engine.recording.logged_tools import ToolLog
from scope_ptz.bench.engine.recording.picture_store import PictureStore
from scope_ptz.bench.engine.recording.transcript import Record, conversation_of
from scope_ptz.bench.engine.stored_run import FRAME_HEIGHT_PX, FRAME_WIDTH_PX, STORE, StoredRun, sample_name
from scope_ptz.bench.engine.trial_records import failure_at_end
from scope_ptz.bench.program_runner import BlankCamera
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.planner.base import Planner
from scope_ptz.simulator.clock import SceneClock

BUILT_IN_AGENT = "scope"
"""Name of SCOPE's own agent loop."""
WIDTH, HEIGHT = FRAME_WIDTH_PX, FRAME_HEIGHT_PX
"""Size of a frame in pixels."""


class BrokenRunError(Exception):
    """A run failed for a reason outside the agent. Inspect does not score it, and repeats it when the evaluation is resumed."""


def agent_solver(
    context: EvalContext,
    *,
    agent: str = BUILT_IN_AGENT,
    pictures: bool = True,
    max_steps: int = 60,
    time_s: float | None = None,
    seed: int = 1,
) -> Solver:
    """Return the solver that runs an agent on each sample.

    Args:
        context: The resources of the evaluation: scenes, models and the watcher.
        agent: "scope" for the built-in loop with its planner, or the name of an external agent. If the context does not start the
            agent, the name must have the form ``module:Class``.
        pictures: Whether to render and log frames. Without frames, only ground-truth perception works.
        max_steps: Number of planner steps after which a run ends (T_max).
        time_s: Wall-clock seconds after which a run ends.
        seed: Seed for every random choice.
    """
    if context.open_agent is not None or agent == BUILT_IN_AGENT:
        open_agent = context.open_agent
    else:
        open_agent = local_agent(agent, AgentOptions()).open

    @solver
    def scope_agent(
        agent: str = BUILT_IN_AGENT,  # noqa: ARG001 - Inspect records the parameters
        pictures: bool = True,
        max_steps: int = 60,
        time_s: float | None = None,
        seed: int = 1,
    ) -> Solver:
        async def solve(state: TaskState, generate: Generate) -> TaskState:  # noqa: ARG001 - Inspect's signature
            entry = Entry.of_metadata(state.metadata)
            context.watcher.run_began(sample_name(entry.facts.id, state.epoch), entry)
            planner: Planner = (
                await LoggedPlanner.of(get_model(role="planner", required=True), context)
                if open_agent is None
                else await open_agent()
            )
            try:
                run = _SampleRun(context, entry, planner, pictures=pictures, seed=seed)
                try:
                    result = await run.run(Budgets(max_steps=max_steps, time_s=time_s))
                finally:
                    await run.store(state)
            finally:
                if isinstance(planner, ChannelPlanner):
                    await planner.close()
            state.output = ModelOutput.from_content(planner.name, result.ended.text)
            state.completed = True
            failure = failure_at_end(result.ended)
            if failure is not None:
                raise BrokenRunError(f"{failure}: {result.ended.text}")
            return state

        return solve

    return scope_agent(agent, pictures, max_steps, time_s, seed)


class _SampleRun:
    """One run of a sample, with its camera, pictures and trace."""

    def __init__(self, context: EvalContext, entry: Entry, planner: Planner, *, pictures: bool, seed: int) -> None:
        self.context, self.entry, self.planner, self.seed = context, entry, planner, seed
        self.scene = context.open_scene(entry.world)
        self.clock = SceneClock(entry.time_s)
        camera = SimulatedCamera if pictures else BlankCamera
        self.camera = camera(self.scene, clock=self.clock, width=WIDTH, height=HEIGHT)
        self.pictures = PictureStore() if pictures else None
        self._records: list[Record] = []

    async def run(self, budgets: Budgets) -> RunResult:
        """Run the agent loop, starting at the task's preset."""
        model = get_model(role="eyes", required=True)
        perception = await LoggedPerception.of(model, self.context, pictures=self.pictures is not None)
        with self.clock.hold():
            await self.camera.go_to_preset(self.entry.facts.preset)
        loop = Agent(
            self.planner,
            self.camera,
            perception,
            self.pictures or NoImages(),
            budgets=budgets,
            labels=RunLabels(seed=self.seed, perception_note=self.context.perception_note),
            snapshots=self.pictures is not None,
            run_tool=ToolLog(self.pictures).run,
        )
        return await loop.run(self.entry.facts.instruction, listener=self._records.append)

    async def store(self, state: TaskState) -> None:
        """Store the data for checks and judges in the sample, even if the run was interrupted."""
        urls = dict[str, str]()
        if self.pictures is not None:
            await self.pictures.encode_pending()
            urls = self.pictures.urls
        state.messages = conversation_of(self._records, urls) or state.messages
        presets = {p.name: p.viewpoint for p in self.scene.file.presets}
        stored_run = StoredRun(
            trace="".join(record.model_dump_json() + "\n" for record in self._records),
            presets=presets,
            home=presets[self.scene.file.home_preset],
            sees=self.planner.sees,
            pictures={name: attachment_reference(url) for name, url in urls.items()},
        )
        state.store.set(STORE, stored_run.to_store())
