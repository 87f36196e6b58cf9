"""Measure the overhead of the evaluation engine. The same tasks run in a bare agent loop and through Inspect AI, without models.

The benchmark compares processor times, so that other load on the machine hardly affects the result.

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
from scope_ptz.factory.evaluation import eval_context, evaluation_planner
from scope_ptz.factory.models import ResolvedPerception, ResolvedPlanner
from scope_ptz.simulator.clock import SceneClock


async def run_bare_loop(entries: tuple[Entry, ...], context: EvalContext, folder: Path, *, pictures: bool) -> float:
    """Return the processor seconds for running all tasks one after the other in a bare agent loop."""
    planner, perception = (
        evaluation_planner(ResolvedPlanner("grammar")),
        await context.make_perception(ModelRequest("ground-truth")),
    )
    start = time.process_time()
    for entry in entries:
        clock, scene = SceneClock(entry.time_s), context.open_scene(entry.world)
        camera = (SimulatedCamera if pictures else BlankCamera)(scene, clock=clock, width=1280, height=720)
        with clock.hold():
            await camera.go_to_preset(entry.facts.preset)
        images = RunFolder.create(folder, entry.facts.instruction) if pictures else NoImages()
        await Agent(planner, camera, perception, images, snapshots=pictures).run(entry.facts.instruction)
    return time.process_time() - start


async def main(tasks: Path, *, pictures: bool) -> None:
    """Run the tasks in the bare loop and through the engine, and print the processor times."""
    context = eval_context(seed=1, perception=ResolvedPerception("ground-truth"))
    entries = context.load_tasks(str(tasks))
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        await run_bare_loop(entries[:3], context, folder, pictures=pictures)  # warm-up: reads scenes, compiles the grammar
        bare_s = await run_bare_loop(entries, context, folder, pictures=pictures)
        options = EvaluationOptions(out=folder / "logs", tasks=str(tasks), pictures=pictures, concurrency=1)
        await evaluate(replace(options, limit=3))  # warm-up: imports the engine
        start = time.process_time()
        evaluation = (await evaluate(options)).evaluation
        engine_s = time.process_time() - start
        size = (await anyio.Path(evaluation.log).stat()).st_size / 1e6
    count = len(entries)
    print(f"{count} runs   bare loop  {bare_s:.1f} s ({1000 * bare_s / count:.0f} ms per run)")
    print(
        f"{'':>{len(str(count))}}        engine     {engine_s:.1f} s ({1000 * engine_s / count:.0f} ms per run), log {size:.1f} MB"
    )
    print(f"ratio {engine_s / bare_s:.2f}, overhead {1000 * (engine_s - bare_s) / count:.0f} ms per run")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tasks", type=Path, help="task file (.jsonl)")
    parser.add_argument("--pictures", action="store_true", help="render and store images")
    arguments = parser.parse_args()
    anyio.run(lambda: main(arguments.tasks, pictures=arguments.pictures))
