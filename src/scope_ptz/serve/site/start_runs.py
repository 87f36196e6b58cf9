"""Start instructions and tool calls, in the same way for all of the server's interfaces."""

from __future__ import annotations

from functools import partial
from typing import Any

from scope_ptz.agent.records import Called
from scope_ptz.errors import InputError, ScopeError
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.run_handle import RunHandle
from scope_ptz.serve.site.runner import RunSpec
from scope_ptz.serve.site.site import Site
from scope_ptz.serve.site.station import Station
from scope_ptz.store.conversations import load_conversation


async def start_instruction(
    site: Site,
    client: Client,
    *,
    camera: str,
    instruction: str,
    conversation: str | None = None,
    pair: str | None = None,
    dry_run: bool = False,
) -> RunHandle:
    """Start an instruction, and return the run's handle after its first record.

    Args:
        site: The site.
        client: The client that gives the instruction.
        camera: The name of the camera.
        instruction: The instruction in plain language.
        conversation: The id of the conversation that the instruction continues; None for none.
        pair: The pair of models; None for the conversation's pair, or else the site's default.
        dry_run: Whether to report moves without carrying them out.

    Raises:
        UnknownNameError: The camera, the conversation or the pair does not exist.
        InputError: The conversation is about another camera.
        NotInControlError: Another client controls the camera.
        BusyError: A run is in progress on the camera.
        ScopeError: The run failed before its first step.
    """
    station, selected_pair = site.station(camera), pair
    if conversation is not None:
        stored = await site.library.in_thread(
            partial(load_conversation, site.library.store.database, conversation, owner=client.name)
        )
        if stored.camera != station.name:
            raise InputError(f"This conversation is about {stored.camera}, not about {station.name}. Start another conversation.")
        selected_pair = selected_pair or stored.pair
    # If a conversation's pair is no longer configured, the default pair is used instead.
    pair_name = site.pairs.check(selected_pair if selected_pair in site.pairs.names or pair is not None else None)
    spec = RunSpec(instruction, pair_name, conversation, "dry_run" if dry_run else "instruction")
    return await site.runner.start(station, spec, client)


async def start_tool_call(
    site: Site, client: Client, station: Station, tool: str, arguments: dict[str, Any], pair: str | None = None
) -> RunHandle:
    """Start a tool call, and return the run's handle after its first record.

    Args:
        site: The site.
        client: The client that calls the tool.
        station: The camera.
        tool: The tool's name.
        arguments: The call's arguments.
        pair: The pair of models; None for the site's default.

    Raises:
        UnknownNameError: The pair does not exist.
        NotInControlError: Another client controls the camera.
        BusyError: A run is in progress on the camera.
        ScopeError: The run failed before its first step.
    """
    return await site.runner.start(station, RunSpec.tool_call(tool, arguments, site.pairs.check(pair)), client)


def finished_call(handle: RunHandle) -> Called:
    """Return the record of the call in an ended run that ``start_tool_call`` started.

    Raises:
        ScopeError: The run failed, or it was cancelled before the call ended.
    """
    called = next((record for record in handle.records if isinstance(record, Called)), None)
    if called is None or handle.failure is not None:
        raise handle.failure or ScopeError("The call was cancelled.")
    return called
