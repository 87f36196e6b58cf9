"""The commands about models and their servers, and their options."""

from __future__ import annotations

from typing import Annotated

import typer

from scope_ptz.cli.endings import ending

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


@models_app.command("pairs")
def pairs(as_json: JsonOption = False) -> None:
    """List the pairs of a planner and eyes: the paper's 19, and more."""
    with ending(as_json=as_json):
        from scope_ptz.cli.models import list_pairs

        list_pairs(as_json=as_json)
