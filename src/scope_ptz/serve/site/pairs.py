"""Pairs of a planner and a perception backend, which requests select by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from anyio import to_thread

from scope_ptz.builtin_names import BUILT_IN_PERCEPTION, GRAMMAR
from scope_ptz.endpoints.catalogue import served_models
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import ServerFailure
from scope_ptz.errors import ScopeError, UnknownNameError
from scope_ptz.factory.cameras import OpenCamera
from scope_ptz.factory.models import ModelOptions, make_perception, make_planner, perception_note, resolve_models
from scope_ptz.perception.base import Perception
from scope_ptz.perception.no_perception import NoPerception
from scope_ptz.planner.base import Planner

DEFAULT_PAIR = f"{GRAMMAR}+{BUILT_IN_PERCEPTION[0]}"

HealthState = Literal["built_in", "ready", "unreachable", "not_configured"]


@dataclass(frozen=True, slots=True)
class Models:
    """A pair's planner and perception backend, ready for use with one camera.

    ``note`` is a sentence about built-in perception, which is stored with each run; it is empty for a vision model.
    """

    planner: Planner
    perception: Perception
    note: str

    async def close(self) -> None:
        """Close the planner and the perception backend."""
        await self.planner.close()
        await self.perception.close()


@dataclass(frozen=True, slots=True)
class Health:
    """The name of a model and whether it can be used."""

    name: str
    state: HealthState


class Pairs:
    """The pairs that requests may name.

    Args:
        names: The pairs, each ``PLANNER+PERCEPTION`` or one model that does both. The first one is the default.
    """

    def __init__(self, names: Sequence[str] = ()) -> None:
        self.names = tuple(dict.fromkeys(names)) or (DEFAULT_PAIR,)

    def check(self, name: str | None) -> str:
        """Check that a pair exists, and return its name. For None, return the default pair's name.

        Raises:
            UnknownNameError: There is no such pair.
        """
        if name is None:
            return self.names[0]
        if name not in self.names:
            raise UnknownNameError("pair", name[:120], self.names)
        return name

    async def open(self, name: str, opened: OpenCamera, seed: int = 0) -> Models:
        """Create a pair's planner and perception backend for a camera.

        On a camera without ground truth, the built-in pair has no perception, so tools that need perception fail.

        Raises:
            InputError: The pair is not configured correctly.
        """
        pair = await resolve_models(_options(name))
        perception: Perception
        if opened.scenes is None and name == DEFAULT_PAIR:
            perception, note = NoPerception("Choose another pair, with a vision model."), ""
        else:
            note = perception_note(pair.perception)
            perception = await to_thread.run_sync(make_perception, pair.perception, opened.scenes, seed)
        # This runs in a thread, because the first call imports the planner, which would delay live video and stop commands.
        return Models(await to_thread.run_sync(make_planner, pair.planner), perception, note)

    async def health(self, name: str) -> tuple[Health, Health]:
        """Return whether a pair's planner and perception backend can be used.

        Raises:
            UnknownNameError: There is no such pair.
        """
        planner, _, perception = self.check(name).partition("+")
        try:
            pair = await resolve_models(_options(name))
        except ScopeError:
            return Health(planner, "not_configured"), Health(perception or planner, "not_configured")
        perception_endpoint = pair.perception.spec.endpoint if pair.perception.spec else None
        planner_health = Health(planner, await _state(pair.planner.endpoint))
        return planner_health, Health(perception or planner, await _state(perception_endpoint))


def _options(name: str) -> ModelOptions:
    return ModelOptions() if name == DEFAULT_PAIR else ModelOptions(pair=name)


async def _state(endpoint: Endpoint | None) -> HealthState:
    if endpoint is None:
        return "built_in"
    try:
        await served_models(endpoint)
    except ServerFailure:
        return "unreachable"
    return "ready"
