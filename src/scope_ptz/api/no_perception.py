"""Placeholder perception for sessions that have none."""

from __future__ import annotations

from typing import NoReturn

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points


class NoPerception(Perception):
    """Perception that raises ``PerceptionError`` on every call, for cameras without ground truth and without a chosen backend.

    Moving the camera and taking frames work without perception.
    """

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
            "This session has no perception, because the camera has no ground truth and no backend was chosen. "
            "Pass perception= to scope_ptz.open with the name of a vision model or a Perception object."
        )
