"""Function calling for other agents: tool schemas in the formats of several APIs, and the outcomes of calls."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from anyio import to_thread

from scope_ptz.agent.planner_views import picture_size
from scope_ptz.camera.guard.guarded_camera import KeepOutError
from scope_ptz.errors import InputError, PerceptionError, ScopeError, ToolCallError, UnknownNameError
from scope_ptz.perception.models.encoding import encode
from scope_ptz.planner.base import Picture, ToolCall, ToolOutcome
from scope_ptz.planner.chat.observations import observation
from scope_ptz.planner.chat.schemas import simplify_schemas
from scope_ptz.planner.chat.strict import encodable
from scope_ptz.planner.chat.written_calls import plain_name, read_arguments, unreadable_arguments
from scope_ptz.tools.registry import schemas
from scope_ptz.tools.results import Result

if TYPE_CHECKING:
    from PIL import Image

SchemaForm = Literal["chat", "responses", "anthropic", "mcp"]
"""An API format for tool schemas, as described in ``Scope.tool_schemas``."""

Arguments = Mapping[str, Any] | str | None
"""The arguments of a call: a mapping, or the JSON text from a model. None and an empty string mean no arguments."""

REPORTED_ERRORS: tuple[type[ScopeError], ...] = (ToolCallError, UnknownNameError, PerceptionError, KeepOutError)
"""Errors to which a model can react, for example with other arguments. ``dispatch`` returns them as text for the model."""


@dataclass(frozen=True, slots=True)
class ToolOutput:
    """The outcome of a tool call that a model made.

    Attributes:
        text: The outcome for the model, as one line of JSON: what the tool found and the pose of the camera, or ``error``. Text
            that perception reported is enclosed in ``<camera_text>``, so that the model can treat it as data.
        result: The result of the tool, such as a ``CountResult``; None if the call failed.
        error: The reason why the call failed; None if it succeeded.
        pictures: The picture that ``take_image`` took, as a JPEG of at most 1280 pixels, for models that accept images.
            ``data_url`` contains the JPEG, and ``caption`` describes it.
    """

    text: str
    result: Result | None = None
    error: str | None = None
    pictures: tuple[Picture, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether the call succeeded."""
        return self.error is None


def schemas_in_form(form: SchemaForm) -> list[dict[str, Any]]:
    """Return the tool schemas in the format that an API accepts.

    Raises:
        InputError: The form is unknown.
    """
    if form not in get_args(SchemaForm):
        raise InputError(f"There is no schema form {form!r}. Use one of: {', '.join(get_args(SchemaForm))}.")
    # MCP clients use the constraints for validation. Model servers may compile schemas to grammars, and reject some keywords.
    tools = schemas() if form == "mcp" else simplify_schemas(schemas())
    return tools if form == "chat" else [_in_form(form, **tool["function"]) for tool in tools]


def _in_form(form: SchemaForm, name: str, description: str, parameters: dict[str, Any]) -> dict[str, Any]:
    named = {"name": name, "description": description}
    if form == "responses":  # strict mode would require every argument in every call
        return {"type": "function", **named, "parameters": parameters, "strict": False}
    return {**named, "input_schema" if form == "anthropic" else "inputSchema": parameters}


async def run_tool_call(
    run_tool: Callable[..., Awaitable[Result]], open_picture: Callable[[str], Image.Image], name: str, arguments: Arguments
) -> ToolOutput:
    """Run a tool call that a model made.

    Args:
        run_tool: Function that runs a tool, called as ``run_tool(Result, name, **arguments)``.
        open_picture: Function that opens a picture stored by ``take_image``, given its name. It is called in a worker thread.
        name: The name that the model sent.
        arguments: The arguments that the model sent.

    Raises:
        ScopeError: The call failed for a reason that a model cannot correct, such as a lost camera.
    """
    call = _read_call(name, arguments)
    try:
        if call.problem is not None:
            raise ToolCallError(call.problem)
        result = await run_tool(Result, call.name, **call.arguments)
    except REPORTED_ERRORS as error:
        return ToolOutput(text=observation(ToolOutcome(call=call, error=str(error))), error=str(error))
    file: str | None = getattr(result, "file", None)
    pictures = () if file is None else (await to_thread.run_sync(_picture, open_picture, file),)
    return ToolOutput(observation(ToolOutcome(call=call, result=result.model_dump(mode="json"))), result, pictures=pictures)


def _read_call(name: str, arguments: Arguments) -> ToolCall:
    called = encodable(plain_name(name))
    try:
        given, malformed = read_arguments(arguments if isinstance(arguments, str) else json.dumps(arguments))
    except (TypeError, ValueError, RecursionError):
        given, malformed = {}, f"a {type(arguments).__name__} that JSON cannot represent"
    problem = None if malformed is None else unreadable_arguments(called, malformed)
    return ToolCall(id="", name=called, arguments=given, problem=problem)


def _picture(open_picture: Callable[[str], Image.Image], name: str) -> Picture:
    with open_picture(name) as opened:
        image = np.asarray(opened.convert("RGB"))
    encoded = encode(image, picture_size(image.shape[1], image.shape[0]))
    return Picture(data_url=encoded.data_url, caption=f"The picture {name}:")
