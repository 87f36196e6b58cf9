"""The commands about models and their servers, and their options."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from scope_ptz.builtin_names import DEFAULT_SCENE
from scope_ptz.cli.endings import ending
from scope_ptz.cli.model_options import (
    DetectorOption,
    PairOption,
    PerceptionKeyOption,
    PerceptionModelOption,
    PerceptionOption,
    PerceptionOptions,
    PerceptionUrlOption,
    PlannerKeyOption,
    PlannerModelOption,
    PlannerOption,
    PlannerOptions,
    PlannerUrlOption,
    ReaderOption,
    TimeoutOption,
    model_options,
)

models_app = typer.Typer(help="The models: list them, show one, say how it is served, list the pairs.", invoke_without_command=True)

JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")]
ModelName = Annotated[str, typer.Argument(metavar="NAME", help="Name of the model; see `scope models`.")]


@models_app.callback()
def models(
    context: typer.Context,
    memory: Annotated[float | None, typer.Option("--memory", min=0.1, help="Only what fits into so many GB.")] = None,
    role: Annotated[str | None, typer.Option("--role", help="Only planner, or only eyes.")] = None,
    as_json: JsonOption = False,
) -> None:
    """List the models: the paper's, current ones, and your own (SCOPE_MODELS)."""
    if context.invoked_subcommand is not None:
        return
    with ending(as_json=as_json):
        from scope_ptz.cli.models import list_models

        list_models(role, memory, as_json=as_json)


@models_app.command("show")
def show(name: ModelName, as_json: JsonOption = False) -> None:
    """Print what is known of a model, with the command for each server that runs it."""
    with ending(as_json=as_json):
        from scope_ptz.cli.models import show_model

        show_model(name, as_json=as_json)


@models_app.command("serve-command")
def serve(
    name: ModelName,
    server: Annotated[
        str | None, typer.Option("--server", help="vllm, sglang, llama.cpp, ollama, ... (default: the first).")
    ] = None,
) -> None:
    """Print the exact command that serves a model."""
    with ending():
        from scope_ptz.cli.models import serve_command

        serve_command(name, server)


@models_app.command("plugins")
def plugins(as_json: JsonOption = False) -> None:
    """List the cameras, planners and perception that installed plug-ins add."""
    with ending(as_json=as_json):
        from scope_ptz.cli.models import list_plugins

        list_plugins(as_json=as_json)


@models_app.command("pairs")
def pairs(as_json: JsonOption = False) -> None:
    """List the pairs of a planner and eyes: the paper's 19, and more."""
    with ending(as_json=as_json):
        from scope_ptz.cli.models import list_pairs

        list_pairs(as_json=as_json)


def profile(
    pair: Annotated[
        str | None, typer.Argument(metavar="PAIR", help="PLANNER+EYES, or one model that is both; see `scope models pairs`.")
    ] = None,
    planner: PlannerOption = None,
    perception: PerceptionOption = None,
    planner_url: PlannerUrlOption = None,
    perception_url: PerceptionUrlOption = None,
    planner_model: PlannerModelOption = None,
    perception_model: PerceptionModelOption = None,
    planner_key_file: PlannerKeyOption = None,
    perception_key_file: PerceptionKeyOption = None,
    planner_option: PlannerOptions = None,
    perception_option: PerceptionOptions = None,
    reader: ReaderOption = None,
    detector: DetectorOption = None,
    timeout: TimeoutOption = None,
    instructions: Annotated[
        Path | None, typer.Option("--instructions", help='File of {"instruction", "calls"} lines in place of the packaged 60.')
    ] = None,
    limit: Annotated[int | None, typer.Option("--limit", min=1, help="Only so many instructions, evenly chosen.")] = None,
    frames: Annotated[int, typer.Option("--frames", min=1, help="Frames that the eyes look at.")] = 6,
    scene: Annotated[str, typer.Option("--scene", help="Scene that the frames are of.")] = DEFAULT_SCENE,
    prompts: Annotated[
        bool, typer.Option("--prompts", help="Also: how tool choice changes with small edits of prompt and instruction.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Measure a pair on your own servers: speed, well-formed calls, perception latency, the paper's real-time bar."""
    with ending(as_json=as_json):
        from scope_ptz.cli.profiling import Extent
        from scope_ptz.cli.profiling import profile as run

        wishes = model_options(
            planner, perception, pair, planner_url, perception_url, planner_model, perception_model, planner_key_file, perception_key_file,
            planner_option, perception_option, reader, detector, timeout,
        )  # fmt: skip
        extent = Extent(instructions=instructions, limit=limit, frames=frames, scene=scene, prompts=prompts)
        sys.exit(run(wishes, extent, as_json=as_json))


def doctor(
    pair: PairOption = None,
    planner: PlannerOption = None,
    perception: PerceptionOption = None,
    planner_url: PlannerUrlOption = None,
    perception_url: PerceptionUrlOption = None,
    planner_model: PlannerModelOption = None,
    perception_model: PerceptionModelOption = None,
    planner_key_file: PlannerKeyOption = None,
    perception_key_file: PerceptionKeyOption = None,
    planner_option: PlannerOptions = None,
    perception_option: PerceptionOptions = None,
    timeout: TimeoutOption = None,
    as_json: JsonOption = False,
) -> None:
    """Say what is installed, reachable and missing; with a server's address: whether it does what SCOPE needs of it."""
    with ending(as_json=as_json):
        wishes = model_options(
            planner, perception, pair, planner_url, perception_url, planner_model, perception_model, planner_key_file, perception_key_file,
            planner_option, perception_option, None, None, timeout,
        )  # fmt: skip
        if any((pair, planner, perception, planner_url, perception_url)):
            from scope_ptz.cli.server_checks import check_servers

            sys.exit(check_servers(wishes, as_json=as_json))
        from scope_ptz.cli.doctor import doctor as run

        sys.exit(run(as_json=as_json))
