"""A site's MCP server, for any transport."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from mcp.server.context import ServerRequestContext
from mcp.server.lowlevel.server import Server
from mcp.shared.exceptions import MCPError
from mcp_types import (
    INVALID_PARAMS,
    CallToolRequestParams,
    CallToolResult,
    CompleteRequestParams,
    CompleteResult,
    Completion,
    GetPromptRequestParams,
    GetPromptResult,
    ListPromptsResult,
    ListResourcesResult,
    ListResourceTemplatesResult,
    ListToolsResult,
    PaginatedRequestParams,
    ReadResourceRequestParams,
    ReadResourceResult,
)

from scope_ptz.errors import ScopeError
from scope_ptz.serve.mcp import prompt, resources
from scope_ptz.serve.mcp.tool import CallContext, McpTool, failure
from scope_ptz.serve.mcp.tools.camera_tools import camera_tools
from scope_ptz.serve.mcp.tools.run_tools import run_tools
from scope_ptz.serve.mcp.tools.site_tools import site_tools
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.error_codes import status_of
from scope_ptz.serve.site.site import Site
from scope_ptz.version import __version__

Context = ServerRequestContext[Any, Any]

logger = logging.getLogger(__name__)


def mcp_server(site: Site, limits: RateLimits, client_of: Callable[[Context], Client]) -> Server[Any]:
    """Return a site's MCP server. The caller must enter the site's context.

    Args:
        site: The cameras, models and runs.
        limits: The rate limits, which may be shared with the HTTP API.
        client_of: Returns the client that sent a request.
    """
    handlers = _Handlers(site, limits, client_of)
    return Server(
        "scope-ptz",
        version=__version__,
        title="SCOPE cameras",
        description="Pan-tilt-zoom cameras that are steered in plain language or by tools.",
        instructions=prompt.INSTRUCTIONS,
        get_tool_input_schema=handlers.input_schema,
        on_list_tools=handlers.list_tools,
        on_call_tool=handlers.call_tool,
        on_list_resources=handlers.list_resources,
        on_list_resource_templates=handlers.list_templates,
        on_read_resource=handlers.read_resource,
        on_list_prompts=handlers.list_prompts,
        on_get_prompt=handlers.get_prompt,
        on_completion=handlers.complete,
    )


class _Handlers:
    """Handles requests. Each handler checks the client's role and counts the request."""

    def __init__(self, site: Site, limits: RateLimits, client_of: Callable[[Context], Client]) -> None:
        self._site, self._limits, self._client_of = site, limits, client_of
        cameras = list(site.stations)
        tools = [*camera_tools(cameras, site.pairs), *run_tools(cameras), *site_tools(cameras)]
        self._tools: dict[str, McpTool] = {tool.name: tool for tool in tools}

    def input_schema(self, name: str) -> dict[str, Any] | None:
        """Return the schema of a tool's arguments; None if there is no such tool."""
        tool = self._tools.get(name)
        return None if tool is None else tool.input_schema

    async def list_tools(self, context: Context, _: PaginatedRequestParams | None) -> ListToolsResult:
        """List the tools that the client may call."""
        client = self._count_read(context)
        return ListToolsResult(
            tools=[tool.listing() for tool in self._tools.values() if client.is_operator or not tool.needs_operator]
        )

    async def call_tool(self, context: Context, params: CallToolRequestParams) -> CallToolResult:
        """Call a tool. An error is returned as a result, so that the agent can read it and correct the call."""
        tool = self._tools.get(params.name)
        if tool is None:
            name, tool_names = _replace_unencodable(params.name[:60]), ", ".join(self._tools)
            raise MCPError(code=INVALID_PARAMS, message=f"There is no tool '{name}'. The tools are {tool_names}.")
        client = self._client_of(context)
        if tool.needs_operator and not client.is_operator:
            return failure(f"{tool.name} needs the operator role, but your token has the viewer role.", "not_allowed")

        async def progress(number: float, message: str) -> None:
            await context.session.report_progress(number, None, message)

        try:
            if tool.kind is not None:
                self._limits.count(client.key, tool.kind, client.name)
            return await tool.run(CallContext(self._site, client, progress), params.arguments or {})
        except ScopeError as error:
            return failure(str(error), status_of(error)[1])
        except Exception:  # a bug must not reveal internals to the client
            logger.exception("The MCP tool %s failed unexpectedly", tool.name)
            return failure(f"{tool.name} failed unexpectedly. The server's log has details.", "failed")

    async def list_resources(self, context: Context, _: PaginatedRequestParams | None) -> ListResourcesResult:
        """List the cameras, presets, scenes and newest runs."""
        self._count_read(context)
        return ListResourcesResult(resources=await resources.resources(self._site))

    async def list_templates(self, context: Context, _: PaginatedRequestParams | None) -> ListResourceTemplatesResult:
        """List the resource templates."""
        self._count_read(context)
        return ListResourceTemplatesResult(resource_templates=resources.templates())

    async def read_resource(self, context: Context, params: ReadResourceRequestParams) -> ReadResourceResult:
        """Read a resource."""
        client = self._count_read(context)
        try:
            return await resources.read_resource(self._site, client, str(params.uri))
        except ScopeError as error:
            raise _protocol_error(error) from error

    async def list_prompts(self, context: Context, _: PaginatedRequestParams | None) -> ListPromptsResult:
        """List the prompts."""
        self._count_read(context)
        return ListPromptsResult(prompts=prompt.prompts())

    async def get_prompt(self, context: Context, params: GetPromptRequestParams) -> GetPromptResult:
        """Return a prompt."""
        self._count_read(context)
        try:
            return prompt.prompt(params.name, params.arguments or {}, list(self._site.stations))
        except ScopeError as error:
            raise _protocol_error(error) from error

    async def complete(self, context: Context, params: CompleteRequestParams) -> CompleteResult:
        """Complete the name of a camera or scene."""
        self._count_read(context)
        values = resources.completions(self._site, params.argument.name, params.argument.value)
        return CompleteResult(completion=Completion(values=values))

    def _count_read(self, context: Context) -> Client:
        """Count a request that only reads, and return the client that sent it."""
        client = self._client_of(context)
        try:
            self._limits.count(client.key, "read", client.name)
        except ScopeError as error:
            raise _protocol_error(error) from error
        return client


def _protocol_error(error: ScopeError) -> MCPError:
    return MCPError(code=INVALID_PARAMS, message=_replace_unencodable(str(error)), data={"error": status_of(error)[1]})


def _replace_unencodable(text: str) -> str:
    return text.encode("utf-8", "replace").decode()
