"""Tasks in the analytic scene: counts, moves and one that the built-in planner gets wrong."""

from __future__ import annotations

from typing import Any

from scope_ptz.bench.tasks.expected import ActionOnly, AnyExpected, Number
from scope_ptz.bench.tasks.task import Aim, Behaviour, Category, EvidenceView, FinalPose, ProgramCall, Task
from scope_ptz.geometry import AXIS_M5075_G

SCENE = "analytic-yard"
YARD = Aim(viewpoint="mast", pan_deg=0.0, tilt_deg=-8.0, zoom=1.0)


def task(number: int, category: Category, instruction: str, expected: AnyExpected, *calls: ProgramCall, **further: Any) -> Task:
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
        **further,
    )


def counting(number: int, what: str, right: int) -> Task:
    """How many of what are in the yard's view."""
    view = EvidenceView(aim=YARD, hfov_deg=AXIS_M5075_G.hfov_deg(1.0), whole=True, shows=Number(value=right, unit=(what,)))
    call = ProgramCall(tool="count_objects", arguments={"description": f"{what}s", "view": "current"})
    wanted = Number(value=right, unit=(what,))
    return task(number, "counting", f"how many {what}s are visible?", wanted, call, evidence=(view,))


def turning(number: int, pan_deg: float) -> Task:
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
    counting(1, "ball", 3),
    counting(2, "block", 7),  # wrong on purpose: the yard's view shows fewer
    turning(1, 20.0),
    turning(2, 30.0),
)


def many(number: int) -> tuple[Task, ...]:
    """Turns, each by another angle."""
    return tuple(turning(n, float(n)) for n in range(1, number + 1))
