"""Perception seen by the engine: every look a model event with the picture that was looked at."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import TypeVar

from inspect_ai.model import ChatMessage, ChatMessageUser, Content, ContentImage, ContentText, Model

from scope_ptz.bench.engine.picture_store import data_url
from scope_ptz.bench.engine.scope_model import LOOK, Asked
from scope_ptz.camera.base import Frame
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points

Eyes = Perception
"""What looks, as the evaluation engine is lent it."""

_Looked = TypeVar("_Looked", Caption, Answer, Detections, Points)


class LoggedPerception(Perception):
    """Eyes whose looks go through a model of the engine, which counts, limits and logs them. The look itself is theirs."""

    def __init__(self, model: Model, eyes: Eyes, *, pictures: bool) -> None:
        self._model, self._eyes, self._pictures = model, eyes, pictures
        self.name, self.skills, self.sees_wide = eyes.name, eyes.skills, eyes.sees_wide

    async def caption(self, frame: Frame) -> Caption:
        return await self._look(frame, "Caption this view.", lambda: self._eyes.caption(frame))

    async def query(self, frame: Frame, question: str) -> Answer:
        return await self._look(frame, question, lambda: self._eyes.query(frame, question))

    async def detect(self, frame: Frame, description: str) -> Detections:
        return await self._look(frame, f"Box: {description}", lambda: self._eyes.detect(frame, description))

    async def point(self, frame: Frame, description: str) -> Points:
        return await self._look(frame, f"Point at: {description}", lambda: self._eyes.point(frame, description))

    async def _look(self, frame: Frame, asked: str, ask: Callable[[], Awaitable[_Looked]]) -> _Looked:
        shown: list[Content] = [ContentImage(image=await data_url(frame))] if self._pictures else []
        message: ChatMessage = ChatMessageUser(content=[*shown, ContentText(text=asked)])
        look = Asked(ask)
        token = LOOK.set(look)
        try:
            await self._model.generate([message])
        finally:
            LOOK.reset(token)
        answer: _Looked = look.answer
        return answer
