"""The core tasks as items of a simulation, with difficulties that are independent of the stored difficulty classes.

The stored classes depend on reference calls, objects to tell apart, and sweeps. The difficulty of an item uses none of these.
It is the sum of:

- the size of the smallest object or text that the answer depends on, in pixels (halving it adds one unit);
- the rotation of the camera by the reference program, in units of 90 degrees;
- the length of the instruction, in units of 8 words.

The sum is then standardised within each category.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import log2

import numpy as np

from scope_ptz.bench.scoring.episode import PresetViewpoints
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.bench.tasks.task import Task
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.factory.worlds import open_worlds

USUAL_PX = 60.0
"""Evidence size, in pixels, of tasks whose answer depends on no single object."""


@dataclass(frozen=True)
class Item:
    """A task with its difficulty: mean 0 and standard deviation 1 within its category."""

    facts: TaskFacts
    difficulty: float


@cache
def core_items() -> tuple[Item, ...]:
    """Return the 536 core tasks as items."""
    tasks = load_split("core")
    viewpoints = {name: PresetViewpoints.of(world.file).presets for name, world in open_worlds(tasks).items()}
    raw = np.array([raw_difficulty(task) for task in tasks])
    z = np.zeros(len(tasks))
    for category in {task.category for task in tasks}:
        members = [n for n, task in enumerate(tasks) if task.category == category]
        z[members] = (raw[members] - raw[members].mean()) / raw[members].std()
    return tuple(
        Item(facts_of(task, viewpoints[task.world][task.preset]), float(value)) for task, value in zip(tasks, z, strict=True)
    )


def other_items(seed: int) -> tuple[Item, ...]:
    """Return the core tasks with difficulties drawn from the standard normal distribution, as for a new set of tasks."""
    rng = np.random.default_rng([seed, 3])
    return tuple(Item(item.facts, float(rng.standard_normal())) for item in core_items())


def raw_difficulty(task: Task) -> float:
    """Return the difficulty of a task before it is standardised."""
    return -log2(smallest_px(task) / USUAL_PX) + rotation_deg(task) / 90 + len(task.instruction.split()) / 8


def smallest_px(task: Task) -> float:
    """Return the size of the smallest object or text that the answer depends on, in pixels."""
    sizes = [item.min_px for view in task.evidence for item in view.items if item.min_px]
    return min(sizes, default=USUAL_PX)


def rotation_deg(task: Task) -> float:
    """Return the total rotation of the camera by the reference program, in degrees."""
    angles = [call.arguments.get(name, 0.0) for call in task.reference for name in ("pan_deg", "tilt_deg")]
    return sum(abs(angle) for angle in angles if isinstance(angle, int | float))


def viewpoints_of(items: Sequence[Item]) -> list[str]:
    """Return the distinct viewpoints of items, by which intervals are clustered."""
    return sorted({f"{item.facts.scene}/{item.facts.viewpoint}" for item in items})
