"""A placeholder for perception in sessions without any."""

from __future__ import annotations

from typing import NoReturn

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points


class NoPerception(Perception):
    """Perception of a camera without ground truth, when none was requested. Moving and taking frames work without it."""

    name = "none"
    skills = frozenset()

    async def caption(self, frame: Frame) -> Caption:  # noqa: ARG002 - the contract's signature
        self._refuse()

    async def query(self, frame: Frame, question: str) -> Answer:  # noqa: ARG002 - the contract's signature
        self._refuse()

    async def detect(self, frame: Frame, description: str) -> Detections:  # noqa: ARG002 - the contract's signature
        self._refuse()

    async def point(self, frame: Frame, description: str) -> Points:  # noqa: ARG002 - the contract's signature
        self._refuse()

    @staticmethod
    def _refuse() -> NoReturn:
        raise PerceptionError(
            "This session has no perception: the camera has no ground truth. Pass perception= to scope_ptz.open, the name of a "
            "vision model or an object of your own."
        )
