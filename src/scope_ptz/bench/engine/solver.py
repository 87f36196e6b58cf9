"""The one adapter between the engine and the agent loop: a sample becomes a run, the run stays in its sample."""

from __future__ import annotations

from inspect_ai.model import ModelOutput, get_model
from inspect_ai.solver import Generate, Solver, TaskState, solver

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Budgets, RunLabels, RunResult
from scope_ptz.agent.store import NoImages
from scope_ptz.bench.engine.context import EvalContext, equipment
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.external_agents import ExternalPlanner, load_external_agent
from scope_ptz.bench.engine.messages import Record, conversation_of
from scope_ptz.bench.engine.models import ScopeModel
from scope_ptz.bench.engine.perception import LoggedPerception
from scope_ptz.bench.engine.pictures import KeptPictures, reference
from scope_ptz.bench.engine.ports import LoggedPlanner, ToolLog
from scope_ptz.bench.engine.sampling import STORE, Kept, sample_name
from scope_ptz.bench.engine.scoring import broken_by
from scope_ptz.bench.program_runner import BlankCamera
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import ConfigError
from scope_ptz.planner.base import Planner
from scope_ptz.simulator.clock import SceneClock

OWN_AGENT = "scope"
WIDTH, HEIGHT = 1280, 720
"""Pixels of a frame."""


class BrokenRunError(Exception):
    """A run that says nothing about the agent. The engine keeps it apart from scores, and runs it again when it goes on."""


@solver
def scope_agent(
    agent: str = OWN_AGENT, pictures: bool = True, max_steps: int = 60, time_s: float | None = None, seed: int = 1
) -> Solver:
    """Run the agent loop on a sample.

    Args:
        agent: "scope" for the loop with its planner, or ``module:Class`` of another agent.
        pictures: draw and keep what the camera shows; without, only eyes that know the ground truth can see.
        max_steps: planner steps (T_max).
        time_s: wall seconds that a run may take.
        seed: of everything random.
    """

    async def solve(state: TaskState, generate: Generate) -> TaskState:  # noqa: ARG001 - the engine's signature
        lent, entry = equipment(), Entry.of_metadata(state.metadata)
        name = sample_name(entry.facts.id, state.epoch)
        lent.watcher.began(name, entry)
        planner: Planner = (
            await LoggedPlanner.of(get_model(role="planner", required=True))
            if agent == OWN_AGENT
            else ExternalPlanner(load_external_agent(agent), agent)
        )
        run = _Sample(lent, entry, planner, pictures=pictures, seed=seed)
        try:
            ended = await run.go(Budgets(max_steps=max_steps, time_s=time_s))
        finally:
            if isinstance(planner, ExternalPlanner):
                await planner.close()
            await run.leave(state)
        state.output = ModelOutput.from_content(planner.name, ended.ended.text)
        state.completed = True
        broken = broken_by(ended.ended)
        if broken is not None:
            raise BrokenRunError(f"{broken}: {ended.ended.text}")
        return state

    return solve


class _Sample:
    """One run: its camera, eyes, pictures and trace."""

    def __init__(self, lent: EvalContext, entry: Entry, planner: Planner, *, pictures: bool, seed: int) -> None:
        self.entry, self.planner, self.seed, self.note = entry, planner, seed, lent.perception_note
        self.scene = lent.open_scene(entry.world)
        self.clock = SceneClock(entry.time_s)
        made = SimulatedCamera if pictures else BlankCamera
        self.camera = made(self.scene, clock=self.clock, width=WIDTH, height=HEIGHT)
        self.pictures = KeptPictures() if pictures else None
        self._records: list[Record] = []

    async def go(self, budgets: Budgets) -> RunResult:
        model = get_model(role="eyes", required=True)
        if not isinstance(model.api, ScopeModel):
            raise ConfigError(f"The role 'eyes' wants a model of this project (scope_ptz/...), not {model}.")
        eyes = LoggedPerception(model, await model.api.eyes(), pictures=self.pictures is not None)
        with self.clock.hold():
            await self.camera.go_to_preset(self.entry.facts.preset)
        loop = Agent(
            self.planner,
            self.camera,
            eyes,
            self.pictures or NoImages(),
            budgets=budgets,
            labels=RunLabels(seed=self.seed, perception_note=self.note),
            snapshots=self.pictures is not None,
            run_tool=ToolLog(self.pictures).run,
        )
        return await loop.run(self.entry.facts.instruction, listener=self._put_down)

    def _put_down(self, record: Record) -> None:
        self._records.append(record)

    async def leave(self, state: TaskState) -> None:
        """Put into the sample what checks and judges need, also of a run that broke off."""
        shown = dict[str, str]()
        if self.pictures is not None:
            await self.pictures.settle()
            shown = self.pictures.kept
        state.messages = conversation_of(self._records, shown) or state.messages
        presets = {p.name: p.viewpoint for p in self.scene.file.presets}
        kept = Kept(
            trace="".join(record.model_dump_json() + "\n" for record in self._records),
            presets=presets,
            home=presets[self.scene.file.home_preset],
            sees=self.planner.sees,
            pictures={name: reference(url) for name, url in shown.items()},
        )
        state.store.set(STORE, kept.as_store())
