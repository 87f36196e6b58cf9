"""What the evaluation engine costs: the same tasks through the bare agent loop and through Inspect AI, without any model.

Processor time is compared, so that other work of the machine does not count.

python benchmarks/evaluation_overhead.py tasks.jsonl [--pictures]
"""

from __future__ import annotations

import argparse
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import anyio

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.store import NoImages, RunFolder
from scope_ptz.bench.engine.context import EvalContext, ModelRequest
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.program_runner import BlankCamera
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.factory.evaluate import EvaluationOptions, evaluate
from scope_ptz.factory.evaluation import eval_context, planner_for
from scope_ptz.factory.models import ResolvedPerception, ResolvedPlanner
from scope_ptz.simulator.clock import SceneClock


async def bare(entries: tuple[Entry, ...], lent: EvalContext, folder: Path, *, pictures: bool) -> float:
    """Processor seconds for all runs, one after the other, without any engine."""
    planner, perception = planner_for(ResolvedPlanner("grammar")), await lent.make_perception(ModelRequest("ground-truth"))
    began = time.process_time()
    for entry in entries:
        clock, scene = SceneClock(entry.time_s), lent.open_scene(entry.world)
        camera = (SimulatedCamera if pictures else BlankCamera)(scene, clock=clock, width=1280, height=720)
        with clock.hold():
            await camera.go_to_preset(entry.facts.preset)
        images = RunFolder.create(folder, entry.facts.instruction) if pictures else NoImages()
        await Agent(planner, camera, perception, images, snapshots=pictures).run(entry.facts.instruction)
    return time.process_time() - began


async def main(tasks: Path, *, pictures: bool) -> None:
    lent = eval_context(seed=1, perception=ResolvedPerception("ground-truth"))
    entries = lent.load_tasks(str(tasks))
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        await bare(entries[:3], lent, folder, pictures=pictures)  # scenes read, grammar compiled
        alone = await bare(entries, lent, folder, pictures=pictures)
        options = EvaluationOptions(out=folder / "logs", tasks=str(tasks), pictures=pictures, concurrency=1)
        await evaluate(replace(options, limit=3))  # the engine imported
        began = time.process_time()
        made = (await evaluate(options)).evaluation
        engine = time.process_time() - began
        size = (await anyio.Path(made.log).stat()).st_size / 1e6
    number = len(entries)
    print(f"{number} runs   bare loop {alone:.1f} s ({1000 * alone / number:.0f} ms a run)")
    print(f"{'':>{len(str(number))}}        engine    {engine:.1f} s ({1000 * engine / number:.0f} ms a run), log {size:.1f} MB")
    print(f"ratio {engine / alone:.2f}, {1000 * (engine - alone) / number:.0f} ms more a run")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tasks", type=Path)
    parser.add_argument("--pictures", action="store_true")
    given = parser.parse_args()
    anyio.run(lambda: main(given.tasks, pictures=given.pictures))
