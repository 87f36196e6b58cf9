"""Wrappers that keep the caller's planner and perception backend open after an evaluation."""

from __future__ import annotations

from typing import Any

from scope_ptz.camera.base import Frame
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points
from scope_ptz.planner.base import Decision, Planner, State


class BorrowedPlanner(Planner):
    """A wrapper around the caller's planner. Its ``close`` does nothing, so that the caller can use the planner again."""

    def __init__(self, planner: Planner) -> None:
        self._planner = planner
        self.name, self.sees = planner.name, planner.sees

    @property
    def details(self) -> dict[str, str]:
        return self._planner.details

    async def step(self, state: State) -> Decision:
        return await self._planner.step(state)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._planner, name)


class BorrowedPerception(Perception):
    """A wrapper around the caller's perception backend. Its ``close`` does nothing, so that the caller can use it again."""

    def __init__(self, perception: Perception) -> None:
        self._perception = perception
        self.name, self.skills, self.handles_panoramas = perception.name, perception.skills, perception.handles_panoramas
        self.version = perception.version

    async def caption(self, frame: Frame) -> Caption:
        return await self._perception.caption(frame)

    async def query(self, frame: Frame, question: str) -> Answer:
        return await self._perception.query(frame, question)

    async def detect(self, frame: Frame, description: str) -> Detections:
        return await self._perception.detect(frame, description)

    async def point(self, frame: Frame, description: str) -> Points:
        return await self._perception.point(frame, description)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._perception, name)
