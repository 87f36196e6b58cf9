"""Run tools through Inspect, so that the log contains a tool event in a separate span for each call."""

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
"""Schema that accepts any arguments. The tool registry validates arguments, so that error messages do not depend on Inspect."""


class ToolLog:
    """Runs tools, and logs each call as a tool event with its result and pictures."""

    def __init__(self, pictures: PictureStore | None) -> None:
        self._pictures = pictures
        self._calls = 0

    async def run(self, context: ToolContext, name: str, arguments: Any) -> Result:
        """Run a tool. Arguments, result and errors are the same as for ``tools.registry.run_tool``."""
        self._calls += 1
        call = ToolCall(id=f"call-{self._calls:03d}", function=name, arguments=arguments)
        outcome: list[Result | ScopeError] = []
        tool = ToolDef(self._tool_function(context, name, outcome), name=name, description=name, parameters=_ANY_ARGUMENTS)
        await execute_tools([ChatMessageAssistant(content="", tool_calls=[call])], [tool])
        result = outcome[0] if outcome else await run_tool(context, name, arguments)
        if isinstance(result, ScopeError):
            raise result
        return result

    def _tool_function(
        self, context: ToolContext, name: str, outcome: list[Result | ScopeError]
    ) -> Callable[..., Awaitable[list[Content]]]:
        logged = set(self._pictures.urls) if self._pictures else set()

        async def call(**kwargs: Any) -> list[Content]:
            try:
                result = await run_tool(context, name, kwargs)
            except (ToolCallError, UnknownNameError, PerceptionError, CameraError) as error:
                outcome.append(error)
                raise ToolError(str(error)) from error
            except ScopeError as error:
                outcome.append(error)
                raise
            outcome.append(result)
            content: list[Content] = [ContentText(text=json.dumps(result.model_dump(mode="json"), ensure_ascii=False))]
            if self._pictures is not None:
                await self._pictures.encode_pending()
                files = [*getattr(result, "frames", ()), getattr(result, "file", None)]
                urls = self._pictures.urls
                content += [ContentImage(image=urls[f]) for f in files if f in urls and f not in logged]
            return content

        return call
