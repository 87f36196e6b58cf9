"""Measure the speed of each perception skill on frames from a scene."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from time import perf_counter

from pydantic import BaseModel, ConfigDict

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.base import Perception
from scope_ptz.planner.profile.speed import Spread

OBJECT, QUESTION = "car", "What is the main thing in this picture? Answer in a few words."


class PerceptionSpeed(BaseModel):
    """The measured seconds per call for each skill.

    Attributes:
        frames: Number of frames.
        by_skill: Median and 95th percentile of the seconds per successful call, by skill.
        never_worked: Skills without a successful call.
        failures: Number of failed calls by failure kind.
        first_failure: The error message from the first failed call.
    """

    model_config = ConfigDict(frozen=True)

    frames: int
    by_skill: dict[str, Spread]
    never_worked: tuple[str, ...] = ()
    failures: dict[str, int]
    first_failure: str = ""

    @property
    def slowest_median_s(self) -> float | None:
        """The slowest skill's median time; None if any skill had no successful call, because that skill's speed is unknown."""
        if self.never_worked:
            return None
        return max((spread.median for spread in self.by_skill.values()), default=None)


async def measure_perception(
    perception: Perception, frames: Sequence[Frame], on_call: Callable[[], None] = lambda: None
) -> PerceptionSpeed:
    """Call each of a backend's skills on every frame, and measure the time.

    A warm-up round, which loads the model and opens the connection, is not counted.

    Args:
        perception: The perception backend to measure.
        frames: The frames. All must differ, so that no reply comes from a cache.
        on_call: Called after each call outside the warm-up round.
    """
    skills: dict[str, Callable[[Frame], Awaitable[object]]] = {
        "query": lambda frame: perception.query(frame, QUESTION),
        "caption": perception.caption,
        "detect": lambda frame: perception.detect(frame, OBJECT),
        "point": lambda frame: perception.point(frame, OBJECT),
    }
    times: dict[str, list[float]] = {name: [] for name in skills if name in perception.skills}
    failures: dict[str, int] = {}
    first_failure = ""
    for number, frame in enumerate([frames[0], *frames]):
        is_measured = number > 0
        for name in times:
            began = perf_counter()
            try:
                await skills[name](frame)
                if is_measured:
                    times[name].append(perf_counter() - began)
            except PerceptionError as error:
                kind, first_failure = error.kind or "perception", first_failure or str(error)
                failures[kind] = failures.get(kind, 0) + is_measured
            if is_measured:
                on_call()
    by_skill = {name: spread for name, values in times.items() if (spread := Spread.of(values)) is not None}
    return PerceptionSpeed(
        frames=len(frames),
        by_skill=by_skill,
        never_worked=tuple(name for name in times if name not in by_skill),
        failures={kind: count for kind, count in failures.items() if count},
        first_failure=first_failure,
    )
