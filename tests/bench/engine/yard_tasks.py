"""Tasks in the analytic scene: counts, moves, and one with a wrong expected answer."""

from __future__ import annotations

from typing import Any

from scope_ptz.bench.tasks.expected import ActionOnly, AnyExpected, Number
from scope_ptz.bench.tasks.task import Aim, Behaviour, Category, EvidenceView, FinalPose, ProgramCall, Task
from scope_ptz.geometry import AXIS_M5075_G

SCENE = "analytic-yard"
YARD = Aim(viewpoint="mast", pan_deg=0.0, tilt_deg=-8.0, zoom=1.0)


def task(number: int, category: Category, instruction: str, expected: AnyExpected, *calls: ProgramCall, **extra: Any) -> Task:
    return Task(
        id=f"scope1-{SCENE}-{category.replace('_', '-')}-{number:03d}",
        dataset="scope1",
        scene=SCENE,
        preset="yard",
        instruction=instruction,
        category=category,
        scope="current",
        difficulty="easy",
        expected=expected,
        reference=calls,
        **extra,
    )


def counting_task(number: int, noun: str, count: int) -> Task:
    """Return a task that counts objects in the yard's view."""
    view = EvidenceView(aim=YARD, hfov_deg=AXIS_M5075_G.hfov_deg(1.0), whole=True, shows=Number(value=count, unit=(noun,)))
    call = ProgramCall(tool="count_objects", arguments={"description": f"{noun}s", "view": "current"})
    answer = Number(value=count, unit=(noun,))
    return task(number, "counting", f"how many {noun}s are visible?", answer, call, evidence=(view,))


def turning_task(number: int, pan_deg: float) -> Task:
    final = FinalPose(viewpoint="mast", pan_deg=pan_deg, tilt_deg=-8.0, zoom=1.0)
    call = ProgramCall(tool="adjust_ptz", arguments={"pan_deg": pan_deg})
    return task(
        number,
        "single_call",
        f"pan right {pan_deg:g} degrees",
        ActionOnly(),
        call,
        behaviour=Behaviour(final=final),
        needs=("move",),
    )


TASKS = (
    counting_task(1, "ball", 3),
    counting_task(2, "block", 7),  # deliberately wrong: the yard's view shows fewer
    turning_task(1, 20.0),
    turning_task(2, 30.0),
)


def turning_tasks(number: int) -> tuple[Task, ...]:
    """Return tasks that turn the camera, each by a different angle."""
    return tuple(turning_task(n, float(n)) for n in range(1, number + 1))
