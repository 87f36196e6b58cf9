"""Measure the accuracy of the grammar planner by category with ground-truth perception, noisy perception or OCR.

    python benchmarks/bench_numbers.py [--split core --split unseen ...] [--perception truth --perception noisy ...]

The tasks run in this process, with the agent loop, the real tools and the checks. With ``rapidocr``, only the tasks of the category
ocr run: rapidocr reads texts, ground truth provides the rest of perception, and images are rendered. Otherwise frames are blank.
Time and memory are those of this process. ``scope bench run`` runs the same tasks through the evaluation engine.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import anyio

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Called, Decided, Ended, Started
from scope_ptz.agent.store import NoImages
from scope_ptz.agent.trace import Trace
from scope_ptz.bench.program_runner import BlankCamera
from scope_ptz.bench.scoring.episode import PresetViewpoints, episode_of
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.bench.tasks.task import Task
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.factory.validation_perception import TruthCache
from scope_ptz.factory.worlds import open_worlds
from scope_ptz.perception.base import Perception
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.noisy import NoisyPerception
from scope_ptz.planner.grammar import GrammarPlanner
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.pack import Scene

WIDTH, HEIGHT = 1280, 720
NOISE_SEED = 1


@dataclass
class Score:
    """The numbers of correct runs and of all runs by category, and descriptions of the runs that were not correct."""

    correct: Counter[str] = field(default_factory=Counter)
    total: Counter[str] = field(default_factory=Counter)
    unscored: int = 0
    failed: list[str] = field(default_factory=list)

    @property
    def micro(self) -> float:
        """The fraction of correct runs."""
        return self.correct.total() / max(1, self.total.total())

    @property
    def macro(self) -> float:
        """The unweighted mean of the accuracies of the categories, which the paper calls the average."""
        return sum(self.correct[name] / n for name, n in self.total.items()) / max(1, len(self.total))

    def lines(self) -> Iterator[str]:
        """Yield lines of text with the accuracy of each category and the averages."""
        for name, n in self.total.items():
            yield f"  {name:<22}{self.correct[name]:>4} of {n:<4}{self.correct[name] / n:>7.1%}"
        yield f"  micro {self.micro:.1%}, macro {self.macro:.1%}; unscored {self.unscored}"


def main() -> int:
    """Run the selected splits with the selected perception backends, and print accuracy, time and memory."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--split", action="append", help="split or task file; repeatable (default: core, unseen, paraphrase)")
    parser.add_argument(
        "--perception",
        action="append",
        choices=("truth", "noisy", "rapidocr"),
        help="perception backend; repeatable (default: truth and noisy)",
    )
    parser.add_argument("--failures", action="store_true", help="list the runs that were not correct, with their reasons")
    parser.add_argument("--json", action="store_true", help="print one JSON document at the end instead of text")
    arguments = parser.parse_args()
    results = {}
    for split in arguments.split or ("core", "unseen", "paraphrase"):
        tasks = load_split(split)
        for perception in arguments.perception or ("truth", "noisy"):
            rows = [task for task in tasks if perception != "rapidocr" or task.category == "ocr"]
            wall_start, cpu_start = time.perf_counter(), time.process_time()
            score = anyio.run(_score, rows, perception)
            wall_s, cpu_s = time.perf_counter() - wall_start, time.process_time() - cpu_start
            peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            results[f"{Path(split).stem} {perception}"] = {
                "right": dict(score.correct), "of": dict(score.total), "micro": score.micro, "macro": score.macro,
                "unscored": score.unscored, "seconds": wall_s, "cpu_seconds": cpu_s, "peak_mb": peak_mb,
            }  # fmt: skip
            if not arguments.json:
                cost = f"{wall_s:.1f} s ({cpu_s:.1f} s of processor time), peak memory so far {peak_mb:.0f} MB"
                print(f"{split}, grammar + {perception}: {len(rows)} tasks in {cost}")
                print("\n".join((*score.lines(), *(score.failed if arguments.failures else ()))), flush=True)
    if arguments.json:
        json.dump(results, sys.stdout, indent=1)
    return 0


async def _score(tasks: Sequence[Task], perception_name: str) -> Score:
    """Run tasks with a perception backend and return their score."""
    worlds, score = open_worlds(tasks), Score()
    perception = _make_perception(perception_name, worlds)
    last_scene = ""
    for task in sorted(tasks, key=lambda t: (t.scene, t.world)):
        if last_scene and last_scene != task.scene:  # Keep the images of only one scene in memory.
            for world in worlds.values():
                world.release()
        last_scene = task.scene
        trace = await _run(task, worlds[task.world], perception, render=perception_name == "rapidocr")
        verdict = score_episode(task, episode_of(trace, PresetViewpoints.of(worlds[task.world].file), keeps_files=False))
        score.total[task.category] += 1
        score.correct[task.category] += verdict.headline == "correct"
        score.unscored += verdict.headline == "unscored"
        if verdict.headline != "correct":
            text = trace.ended.text if trace.ended else ""
            score.failed.append(f"    {task.id} {verdict.headline}: {task.instruction!r} -> {text!r}: {verdict.reason}")
    return score


def _make_perception(name: str, worlds: Mapping[str, Scene]) -> Perception:
    truth = GroundTruthPerception(lambda world: worlds[world], TruthCache().read)
    if name == "noisy":
        return NoisyPerception(truth, seed=NOISE_SEED)
    if name == "truth":
        return truth
    from scope_ptz.perception.backends import make_backend
    from scope_ptz.perception.backends.spec import BackendSpec
    from scope_ptz.perception.models.routing import RouterPerception

    return RouterPerception(reader=make_backend(BackendSpec(name="rapidocr", backend="ocr")), detector=truth, answerer=truth)


async def _run(task: Task, world: Scene, perception: Perception, *, render: bool) -> Trace:
    """Run a task with the grammar planner and return its trace. With ``render`` false, frames are blank."""
    clock = SceneClock(task.time_s)
    camera = (SimulatedCamera if render else BlankCamera)(world, clock=clock, width=WIDTH, height=HEIGHT)
    with clock.hold():
        await camera.go_to_preset(task.preset)
    records = list[Started | Decided | Called | Ended]()
    agent = Agent(GrammarPlanner(), camera, perception, NoImages(), snapshots=False)
    await agent.run(task.instruction, listener=records.append)
    started, ended = records[0], records[-1]
    assert isinstance(started, Started)
    return Trace(
        folder=Path(),
        started=started,
        decisions=tuple(r for r in records if isinstance(r, Decided)),
        calls=tuple(r for r in records if isinstance(r, Called)),
        ended=ended if isinstance(ended, Ended) else None,
    )


if __name__ == "__main__":
    sys.exit(main())
