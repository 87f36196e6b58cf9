"""Tool calls seen by the engine: each call is a tool event in a span of its own."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable
from typing import Any

from inspect_ai.model import ChatMessageAssistant, Content, ContentImage, ContentText, execute_tools
from inspect_ai.tool import ToolCall, ToolDef, ToolError, ToolParams

from scope_ptz.bench.engine.recording.picture_store import PictureStore
from scope_ptz.errors import CameraError, PerceptionError, ScopeError, ToolCallError, UnknownNameError
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.registry import run_tool
from scope_ptz.tools.results import Result

_ANY_ARGUMENTS = ToolParams(additionalProperties=True)
"""Arguments are validated where the call is made, so that a planner reads the same errors in every program."""


class ToolLog:
    """Makes tool calls inside tool events. The log shows the pictures that a call took with its result."""

    def __init__(self, pictures: PictureStore | None) -> None:
        self._pictures = pictures
        self._calls = 0

    async def run(self, context: ToolContext, name: str, arguments: Any) -> Result:
        """Run a tool. Arguments, result and errors are those of ``tools.registry.run_tool``."""
        self._calls += 1
        call = ToolCall(id=f"call-{self._calls:03d}", function=name, arguments=arguments)
        came: list[Result | ScopeError] = []
        tool = ToolDef(self._body(context, name, came), name=name, description=name, parameters=_ANY_ARGUMENTS)
        await execute_tools([ChatMessageAssistant(content="", tool_calls=[call])], [tool])
        result = came[0] if came else await run_tool(context, name, arguments)
        if isinstance(result, ScopeError):
            raise result
        return result

    def _body(self, context: ToolContext, name: str, came: list[Result | ScopeError]) -> Callable[..., Awaitable[list[Content]]]:
        known = set(self._pictures.kept) if self._pictures else set()

        async def call(**kwargs: Any) -> list[Content]:
            try:
                result = await run_tool(context, name, kwargs)
            except (ToolCallError, UnknownNameError, PerceptionError, CameraError) as error:
                came.append(error)
                raise ToolError(str(error)) from error
            except ScopeError as error:
                came.append(error)
                raise
            came.append(result)
            shown: list[Content] = [ContentText(text=json.dumps(result.model_dump(mode="json"), ensure_ascii=False))]
            if self._pictures is not None:
                await self._pictures.settle()
                files = [*getattr(result, "frames", ()), getattr(result, "file", None)]
                shown += [ContentImage(image=self._pictures.kept[f]) for f in files if f in self._pictures.kept and f not in known]
            return shown

        return call
