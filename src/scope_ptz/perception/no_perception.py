"""The placeholder backend for sessions without perception."""

from __future__ import annotations

from typing import NoReturn

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points


class NoPerception(Perception):
    """A placeholder that raises ``PerceptionError`` on every call, for cameras without ground truth.

    Moving the camera and taking frames work without perception.

    Args:
        advice: A sentence that tells the user how to choose a backend.
    """

    name = "none"
    skills = frozenset()

    def __init__(self, advice: str) -> None:
        self._advice = advice

    async def caption(self, frame: Frame) -> Caption:  # noqa: ARG002 - the contract's signature
        self._raise_error()

    async def query(self, frame: Frame, question: str) -> Answer:  # noqa: ARG002 - the contract's signature
        self._raise_error()

    async def detect(self, frame: Frame, description: str) -> Detections:  # noqa: ARG002 - the contract's signature
        self._raise_error()

    async def point(self, frame: Frame, description: str) -> Points:  # noqa: ARG002 - the contract's signature
        self._raise_error()

    def _raise_error(self) -> NoReturn:
        raise PerceptionError(
            f"This session has no perception backend, because the camera has no ground truth and none was chosen. {self._advice}"
        )
