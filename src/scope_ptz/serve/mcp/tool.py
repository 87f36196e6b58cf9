"""The definition of an MCP tool, and the context for a call."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from mcp_types import CallToolResult, ContentBlock, TextContent, ToolAnnotations
from mcp_types import Tool as ListedTool
from pydantic import BaseModel, ConfigDict, ValidationError

from scope_ptz.errors import ToolCallError
from scope_ptz.serve.mcp.pictures import MAX_RESULT_BYTES
from scope_ptz.serve.security.rate_limits import RequestKind
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.site import Site

MAX_ENUMERATED_NAMES = 50
"""Maximum number of names that a schema enumerates. If there are more, the error for an unknown name lists the names."""

ReportProgress = Callable[[float, str], Awaitable[None]]


@dataclass(frozen=True, slots=True)
class CallContext:
    """The context for a call.

    Attributes:
        site: The cameras, runs and conversations.
        client: The client that makes the call.
        progress: Reports progress to the client: an increasing number and a message without text from pictures.
    """

    site: Site
    client: Client
    progress: ReportProgress


class ToolArguments(BaseModel):
    """Base class for the arguments of tools other than the nine camera tools. Wrong types and unknown fields are errors."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


@dataclass(frozen=True, slots=True)
class McpTool:
    """A tool that MCP clients can call.

    Attributes:
        name: The name in calls.
        title: The name for people.
        description: The description for the agent.
        input_schema: JSON schema for the arguments.
        output_schema: JSON schema for the structured result.
        annotations: Hints about effects.
        needs_operator: Whether the tool needs the operator role.
        kind: The rate limit that applies; None for no limit, so that stopping is always possible.
        run: Carries out a call with the given arguments.
    """

    name: str
    title: str
    description: str
    input_schema: dict[str, Any]
    output_schema: dict[str, Any]
    annotations: ToolAnnotations
    needs_operator: bool
    kind: RequestKind | None
    run: Callable[[CallContext, dict[str, Any]], Awaitable[CallToolResult]]

    def listing(self) -> ListedTool:
        """Return the tool's entry for ``tools/list``."""
        return ListedTool(
            name=self.name,
            title=self.title,
            description=self.description,
            input_schema=self.input_schema,
            output_schema=self.output_schema,
            annotations=self.annotations,
        )


_Model = TypeVar("_Model", bound=BaseModel)


def parse_arguments(model: type[_Model], tool: str, arguments: dict[str, Any]) -> _Model:
    """Validate a call's arguments.

    Raises:
        ToolCallError: An argument is missing, unknown or has the wrong type. The message states how to correct the call.
    """
    try:
        return model.model_validate(arguments)
    except ValidationError as error:
        problems = "; ".join(
            f"{'.'.join(str(part)[:60] for part in problem['loc']) or 'arguments'}: {problem['msg']}"
            for problem in error.errors(include_url=False, include_input=False)
        )
        fields = ", ".join(model.model_fields) or "no arguments"
        raise ToolCallError(f"Wrong arguments for {tool}: {problems}. It takes {fields}.") from error


def input_schema(model: type[BaseModel], cameras: Sequence[str]) -> dict[str, Any]:
    """Return the JSON schema for arguments, in which ``camera`` enumerates the camera names."""
    schema = remove_titles(model.model_json_schema())
    schema.pop("description", None)
    if "camera" in schema.get("properties", {}):
        schema["properties"]["camera"] = camera_property(cameras)
    return {**schema, "properties": schema.get("properties", {})}


def output_schema(model: type[BaseModel]) -> dict[str, Any]:
    """Return the JSON schema for a structured result."""
    schema: dict[str, Any] = remove_titles(model.model_json_schema(mode="serialization"))
    return schema


def camera_property(cameras: Sequence[str]) -> dict[str, Any]:
    """Return the JSON schema for the argument ``camera``."""
    enumeration: dict[str, Any] = {"enum": list(cameras)} if len(cameras) <= MAX_ENUMERATED_NAMES else {}
    return {"type": "string", "description": "Name of the camera, as list_cameras reports it.", **enumeration}


def remove_titles(schema: Any) -> Any:
    """Remove the titles that pydantic derives from names from a JSON schema. A property named "title" is kept."""
    if isinstance(schema, list):
        return [remove_titles(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    return {
        key: {name: remove_titles(item) for name, item in value.items()} if key in ("properties", "$defs") else remove_titles(value)
        for key, value in schema.items()
        if not (key == "title" and isinstance(value, str))
    }


def reply(text: str, data: BaseModel | dict[str, Any], *more: ContentBlock, failed: bool = False) -> CallToolResult:
    """Return a call's result.

    Args:
        text: The result for agents that read only text.
        data: The structured result.
        *more: Pictures and links, the least important last. They are omitted if the result would be too large.
        failed: Whether the call failed.
    """
    structured = data.model_dump(mode="json") if isinstance(data, BaseModel) else data
    content: list[ContentBlock] = [TextContent(type="text", text=text), *more]
    result = CallToolResult(content=content, structured_content=structured, is_error=failed)
    while wire_bytes(result) > MAX_RESULT_BYTES and len(result.content) > 1:
        result = result.model_copy(update={"content": result.content[:-1]})
    return result


def wire_bytes(result: BaseModel) -> int:
    """Return the size of a result as a JSON message, in bytes, in the largest encoding: one that escapes non-ASCII characters."""
    envelope_bytes = 512  # the message's id and version, and metadata that the SDK adds
    return envelope_bytes + len(json.dumps(result.model_dump(mode="json", by_alias=True, exclude_none=True)))


def failure(message: str, code: str) -> CallToolResult:
    """Return the result for a call that failed before it had any effect. ``code`` is the code that the HTTP API reports."""
    text = message.encode("utf-8", "replace").decode()
    return CallToolResult(content=[TextContent(type="text", text=text)], is_error=True, _meta={"scope-ptz/error": code})
