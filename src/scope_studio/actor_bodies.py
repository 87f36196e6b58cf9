"""Build the bodies of moving actors on first use, and place them on their paths at a given time."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from scope_studio.kit.core.stage import INSTANCE_PROP, ActorPath, Built, Stage

GAIT_PHASES = 8
"""Maximum number of bodies that are built for a walking actor. Each shows one phase of its gait."""


class ActorBodies:
    """The bodies of all actors of a stage. A body is hidden from renders unless ``place`` or ``show_at`` shows it."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._bodies: dict[tuple[str, int], Built] = {}

    def body(self, actor: ActorPath, phase: float) -> Built:
        """Return the actor's body for a gait phase in [0, 1), rounded to one of ``GAIT_PHASES`` steps. Build it on first use."""
        index = round(phase * GAIT_PHASES) % GAIT_PHASES if actor.stride_m else 0
        key = (actor.id, index)
        if key not in self._bodies:
            existing = tuple(m.name for m in bpy.data.materials)
            built = actor.build(index / GAIT_PHASES)
            self._stage.finish(skip=existing)
            for obj in built.objects:
                obj[INSTANCE_PROP] = actor.id
                obj.pass_index = actor.number
            set_visible(built, False)
            self._bodies[key] = built
        return self._bodies[key]

    def place(self, actor: ActorPath, time_s: float, phase: float | None = None) -> Built | None:
        """Move the actor's body to its position at a scene time and show it.

        Returns:
            The body, or None if the actor is not in the scene at that time.
        """
        t = time_s % actor.period_s
        if not actor.waypoints[0][0] <= t <= actor.waypoints[-1][0]:
            return None
        position, bearing_deg, travelled_m = position_at(actor, t)
        if phase is None:
            phase = (travelled_m / actor.stride_m) % 1.0 if actor.stride_m else 0.0
        built = self.body(actor, phase)
        self._stage.put(built, position, bearing_deg)
        set_visible(built, True)
        return built

    @contextmanager
    def show_at(self, time_s: float) -> Iterator[None]:
        """Show every actor that is in the scene at a time, while the context is active."""
        shown = [built for actor in self._stage.actors if (built := self.place(actor, time_s)) is not None]
        bpy.context.view_layer.update()
        try:
            yield
        finally:
            for built in shown:
                set_visible(built, False)

    def size_m(self, actor: ActorPath) -> tuple[float, float, float]:
        """Return the width, length and height of the actor's body in metres."""
        built = self.body(actor, 0.0)
        self._stage.put(built, (0.0, 0.0, 0.0), 0.0)
        bpy.context.view_layer.update()
        corners = np.array([obj.matrix_world @ v.co for obj in built.objects if obj.type == "MESH" for v in obj.data.vertices])
        half_size = np.abs(corners).max(axis=0)
        return float(2 * half_size[0]), float(2 * half_size[1]), float(corners[:, 2].max())


def position_at(actor: ActorPath, t: float) -> tuple[tuple[float, float, float], float, float]:
    """Return the actor's position (m), bearing (degrees) and distance travelled (m) at a time on its path."""
    travelled_m = 0.0
    last = len(actor.waypoints) - 2
    for k, (a, b) in enumerate(zip(actor.waypoints, actor.waypoints[1:], strict=False)):
        length_m = math.dist(a[1:], b[1:])
        if t <= b[0] or k == last:
            fraction = 0.0 if b[0] == a[0] else (t - a[0]) / (b[0] - a[0])
            x, y, z = (a[i] + (b[i] - a[i]) * fraction for i in (1, 2, 3))
            return (x, y, z), math.degrees(math.atan2(b[1] - a[1], b[2] - a[2])), travelled_m + length_m * fraction
        travelled_m += length_m
    raise ValueError(f"the path of {actor.id} must have at least two waypoints")


def set_visible(built: Built, visible: bool) -> None:
    """Show or hide the objects of ``built`` in renders.

    The viewport's visibility flag stays on, because Cycles does not export objects that are hidden in the viewport.
    """
    for obj in built.objects:
        obj.hide_render = not visible
