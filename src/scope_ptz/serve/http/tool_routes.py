"""Routes that call a camera's nine tools directly, one operation for each tool."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Request
from fastapi.exceptions import RequestValidationError
from pydantic import Field, ValidationError

from scope_ptz.serve.http.dependencies import Operator, SiteDep, StationDep, Viewer
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.http.models import PoseModel, ToolReply
from scope_ptz.serve.site.error_codes import status_of
from scope_ptz.serve.site.start_runs import finished_call, start_tool_call
from scope_ptz.tools.registry import TOOLS, schemas
from scope_ptz.tools.tool import Tool

router = APIRouter(tags=["tools"])


@router.get("/tools", responses=responses())
async def list_tools(client: Viewer) -> list[dict[str, Any]]:  # noqa: ARG001 - checks the token
    """Return the schemas of the tools in the OpenAI function format."""
    return schemas()


def _add_route(tool: Tool) -> None:
    arguments = tool.arguments
    body = {"required": bool(arguments.model_json_schema().get("required")), "content": {"application/json": {"schema": {}}}}
    body["content"] = {"application/json": {"schema": _schema(tool)}}

    async def call(
        request: Request,
        site: SiteDep,
        station: StationDep,
        client: Operator,
        pair: Annotated[str | None, Field(min_length=1, max_length=120)] = None,
    ) -> ToolReply:
        parsed = await _arguments(request, tool)
        handle = await start_tool_call(site, client, station, tool.name, parsed, pair)
        await handle.done.wait()
        called = finished_call(handle)
        outcome, error = called.outcome, handle.call_error
        return ToolReply(
            run=handle.id,
            result=outcome.result,
            error=outcome.error,
            fault=called.fault,
            code=None if error is None or outcome.error is None else status_of(error)[1],
            pose=PoseModel.of(called.pose.pose()),
        )

    summary = (arguments.__doc__ or tool.name).strip().splitlines()[0]
    router.add_api_route(
        f"/cameras/{{camera}}/tools/{tool.name}",
        call,
        methods=["POST"],
        name=tool.name,
        operation_id=f"call_{tool.name}",
        description=f"{summary}\n\nFailures are reported in `error`, `fault` and `code`. Each call is stored as a one-step run.",
        responses=responses(404, 409, 503),
        openapi_extra={"requestBody": body},
    )


def _schema(tool: Tool) -> dict[str, Any]:
    return tool.arguments.model_json_schema()


async def _arguments(request: Request, tool: Tool) -> dict[str, Any]:
    """Return a call's validated arguments. Conflicts between arguments are not checked, because the tool itself reports them.

    Raises:
        RequestValidationError: The body is not a JSON object, or an argument is unknown or has the wrong type.
    """
    import json

    content = await request.body()
    try:
        parsed = json.loads(content) if content.strip() else {}
        if not isinstance(parsed, dict):
            raise RequestValidationError([{"loc": ("body",), "msg": "Expected a JSON object of arguments", "type": "dict_type"}])
        tool.arguments.model_validate(parsed)
    except (ValueError, RecursionError) as error:
        if not isinstance(error, ValidationError):
            raise RequestValidationError(
                [{"loc": ("body",), "msg": "The body is not valid JSON", "type": "json_invalid"}]
            ) from error
        problems = [problem for problem in error.errors(include_url=False, include_input=False) if problem["loc"]]
        if problems:
            raise RequestValidationError([{**problem, "loc": ("body", *problem["loc"])} for problem in problems]) from error
    return parsed


for _tool in TOOLS.values():
    _add_route(_tool)
