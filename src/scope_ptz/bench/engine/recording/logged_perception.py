"""A perception backend that makes its calls through an Inspect model, so that the log contains each call with its picture."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import TypeVar

from inspect_ai.model import ChatMessage, ChatMessageUser, Content, ContentImage, ContentText, Model

from scope_ptz.bench.engine.context import EvalContext
from scope_ptz.bench.engine.recording.picture_store import data_url
from scope_ptz.bench.engine.recording.scope_model import ScopeModel
from scope_ptz.camera.base import Frame
from scope_ptz.errors import ConfigError
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points

_Observation = TypeVar("_Observation", Caption, Answer, Detections, Points)


class LoggedPerception(Perception):
    """A perception backend that makes its calls through an Inspect model, which counts, limits and logs them."""

    def __init__(self, model: Model, api: ScopeModel, perception: Perception, *, pictures: bool) -> None:
        self._model, self._api, self._perception, self._pictures = model, api, perception, pictures
        self.name, self.skills, self.handles_panoramas = perception.name, perception.skills, perception.handles_panoramas
        self.version = perception.version

    @classmethod
    async def of(cls, model: Model, context: EvalContext, *, pictures: bool) -> LoggedPerception:
        """Create the perception backend for an Inspect model. Raises ``ConfigError`` if the model is not a ``ScopeModel``."""
        if not isinstance(model.api, ScopeModel):
            raise ConfigError(f"The model in the role 'eyes' must be a SCOPE model (scope_ptz/...); got {model}.")
        return cls(model, model.api, await model.api.perception(context), pictures=pictures)

    async def caption(self, frame: Frame) -> Caption:
        return await self._call(frame, "Caption this view.", lambda: self._perception.caption(frame))

    async def query(self, frame: Frame, question: str) -> Answer:
        return await self._call(frame, question, lambda: self._perception.query(frame, question))

    async def detect(self, frame: Frame, description: str) -> Detections:
        return await self._call(frame, f"Box: {description}", lambda: self._perception.detect(frame, description))

    async def point(self, frame: Frame, description: str) -> Points:
        return await self._call(frame, f"Point at: {description}", lambda: self._perception.point(frame, description))

    async def _call(self, frame: Frame, text: str, call: Callable[[], Awaitable[_Observation]]) -> _Observation:
        pictures: list[Content] = [ContentImage(image=await data_url(frame))] if self._pictures else []
        message: ChatMessage = ChatMessageUser(content=[*pictures, ContentText(text=text)])
        return await self._api.logged_call(self._model, [message], call)
