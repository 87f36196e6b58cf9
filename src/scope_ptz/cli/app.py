"""The ``scope`` app: its command groups, and the commands of all groups that are not loaded lazily.

Commands import what they need when they run, so that help starts fast.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from scope_ptz.builtin_names import DEFAULT_SCENE
from scope_ptz.cli import pause_garbage_collection
from scope_ptz.cli.bench import HELP as BENCH_HELP
from scope_ptz.cli.bench import BenchGroup
from scope_ptz.cli.camera import HELP as CAMERA_HELP
from scope_ptz.cli.camera import CameraGroup
from scope_ptz.cli.exit import EXIT_CODES
from scope_ptz.cli.options import JsonOption, ModelFlags, PairFlags, ServerFlags, SessionFlags, TokensFile
from scope_ptz.cli.typer_extensions import LazyGroup, LeanGroup, command

_HELP = {"help_option_names": ["-h", "--help"]}
_RUNS_HELP = """Stored runs: list, show, index, export and prune them; list audit logs.

Runs are stored in the runs folder (SCOPE_RUNS_DIR, or --runs-dir). Its file `store.sqlite` is an index that can be rebuilt.
"""


class _RunsGroup(LazyGroup):
    """The commands for stored runs."""

    def load_app(self) -> typer.Typer:
        from scope_ptz.cli.runs import runs_app

        return runs_app


class _SceneGroup(LazyGroup, LeanGroup):
    """The commands for scenes."""

    def load_app(self) -> typer.Typer:
        from scope_ptz.cli.scenes import scene_app

        return scene_app


app = typer.Typer(
    cls=LeanGroup,
    help="Talk to a pan-tilt-zoom camera in plain language.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
    context_settings=_HELP,
)
scene_app = typer.Typer(cls=_SceneGroup, help="List, show, view, build, bake and verify scenes.", no_args_is_help=True)
models_app = typer.Typer(
    cls=LeanGroup, help="List models, pairs and plug-ins, and print how to serve a model.", invoke_without_command=True
)
token_app = typer.Typer(cls=LeanGroup, help="Add, list and remove tokens for `scope serve`.", no_args_is_help=True)
addon_app = typer.Typer(cls=LeanGroup, help="Build the add-on for Blender.", no_args_is_help=True)
app.add_typer(addon_app, name="blender-addon", rich_help_panel="Set up")
app.add_typer(scene_app, name="scene", rich_help_panel="Set up")
app.add_typer(models_app, name="models", rich_help_panel="Set up")
app.add_typer(token_app, name="token", rich_help_panel="Set up")
app.add_typer(
    typer.Typer(cls=CameraGroup, help=CAMERA_HELP, no_args_is_help=True), name="camera", rich_help_panel="Talk to a camera"
)
app.add_typer(typer.Typer(cls=_RunsGroup, help=_RUNS_HELP, no_args_is_help=True), name="runs", rich_help_panel="Talk to a camera")
app.add_typer(typer.Typer(cls=BenchGroup, help=BENCH_HELP, no_args_is_help=True), name="bench", rich_help_panel="Measure")

_INSTRUCTION = typer.Argument(help="What the camera should do, in plain words.")
TokenUser = Annotated[str, typer.Argument(help="Name of the person or program that uses the token.")]
ModelName = Annotated[str, typer.Argument(metavar="NAME", help="Name of the model; see `scope models`.")]


def _version(requested: bool) -> None:
    if requested:
        from scope_ptz.version import __version__

        sys.stdout.write(f"scope-ptz {__version__}\n")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")] = False,
) -> None:
    """Talk to a pan-tilt-zoom camera in plain language."""


# Talking to a camera ---------------------------------------------------------------------------------------------------
@app.command(epilog=EXIT_CODES, rich_help_panel="Talk to a camera")
@command
def ask(
    instruction: Annotated[str, _INSTRUCTION],
    session: SessionFlags,
    models: PairFlags,
    next_steps: Annotated[bool, typer.Option("--next-steps", help="Print commands to try next.")] = False,
    as_json: JsonOption = False,
) -> int:
    """Carry out one instruction and save the run: its trace, frames and a filmstrip."""
    with pause_garbage_collection():
        from scope_ptz.cli.ask import ask as run

    return run(instruction, session, models.options(), as_json=as_json, next_steps=next_steps)


@app.command(rich_help_panel="Talk to a camera")
@command
def chat(session: SessionFlags, models: PairFlags) -> int:
    """Give several instructions in one conversation. Type /help in the chat to list its commands."""
    from scope_ptz.cli.chat import chat as run

    return run(session, models.options())


@app.command(rich_help_panel="Talk to a camera")
@command
def plan(
    instruction: Annotated[str | None, _INSTRUCTION] = None,
    presets: Annotated[str | None, typer.Option("--presets", help="Names of the camera's presets, separated by commas.")] = None,
    source: Annotated[
        Path | None, typer.Option("--from", help='File of {"instruction", "presets"} lines; "-" reads stdin.')
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Show the tool calls that the built-in planner would make, without moving a camera."""
    with pause_garbage_collection():
        from scope_ptz.cli.plan import plan as run

    return run(instruction, presets, source, as_json=as_json)


@app.command(rich_help_panel="Talk to a camera")
@command
def replay(
    run_dir: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder, or a trace file.")],
    as_json: JsonOption = False,
) -> int:
    """Repeat a run from its trace, without models, and report whether the results are the same."""
    from scope_ptz.cli.ask import replay as run

    return run(run_dir, as_json=as_json)


@app.command(rich_help_panel="Talk to a camera")
@command
def tools(as_json: Annotated[bool, typer.Option("--json", help="Print on one line instead of indented.")] = False) -> None:
    """Print the schemas of the nine tools in the OpenAI function format."""
    from scope_ptz.cli.exit import put_json
    from scope_ptz.tools.schemas import stored_schemas

    put_json(stored_schemas(), indent=None if as_json else 2)


@app.command(rich_help_panel="Talk to a camera")
@command
def serve(
    server: ServerFlags,
    as_json: JsonOption = False,
) -> None:
    """Serve cameras to programs through an HTTP API until Ctrl-C."""
    from scope_ptz.cli.serve import run_server

    run_server(server, as_json=as_json)


@app.command(rich_help_panel="Talk to a camera")
@command
def console(
    server: ServerFlags,
    as_json: JsonOption = False,
) -> None:
    """Serve the operator console to browsers, together with the HTTP API, until Ctrl-C."""
    from scope_ptz.cli.serve import run_server

    run_server(server, kind="page", as_json=as_json)


@app.command(rich_help_panel="Talk to a camera")
@command
def mcp(
    server: ServerFlags,
    transport: Annotated[
        str, typer.Option("--transport", help="Transport: stdio (for a program that starts this command) or http.")
    ] = "stdio",
    role: Annotated[
        str, typer.Option("--role", help="Role of the stdio client: operator, or viewer (can watch but not send commands).")
    ] = "operator",
    as_json: JsonOption = False,
) -> None:
    """Serve cameras to assistants and coding agents that speak MCP, on standard input and output or over HTTP."""
    from scope_ptz.cli.serve import run_mcp

    run_mcp(server, transport, role, as_json=as_json)


# The add-on for Blender --------------------------------------------------------------------------------------------------
@addon_app.command("build")
@command
def addon_build(
    out: Annotated[Path, typer.Option("--out", "-o", help="File to write (default: scope-addon.zip).")] = Path("scope-addon.zip"),
    as_json: JsonOption = False,
) -> None:
    """Build one zip file that Blender 3.4 to 4.1 installs as an add-on, and Blender 4.2 or later as an extension."""
    from scope_ptz.blender.addon_zip import write_addon_zip
    from scope_ptz.cli.exit import put, put_json

    write_addon_zip(out)
    if as_json:
        put_json({"file": str(out.absolute())})
        return
    put(f"Wrote {out}.")
    put("Blender 4.2 or later: Edit > Preferences > Get Extensions > menu at the top right > Install from Disk.")
    put("Blender 3.4 to 4.1: Edit > Preferences > Add-ons > Install, then enable SCOPE.")


# Tokens ----------------------------------------------------------------------------------------------------------------
@token_app.command("add")
@command
def token_add(
    name: TokenUser,
    role: Annotated[str, typer.Option("--role", help="Role: viewer (can watch) or operator (can also send commands).")] = "viewer",
    tokens: TokensFile = None,
    as_json: JsonOption = False,
) -> None:
    """Create a token and print it. Only its hash is stored."""
    from scope_ptz.cli.serve import add_token

    add_token(name, role, tokens, as_json=as_json)


@token_app.command("list")
@command
def token_list(tokens: TokensFile = None, as_json: JsonOption = False) -> None:
    """List the names and roles of tokens."""
    from scope_ptz.cli.serve import list_tokens

    list_tokens(tokens, as_json=as_json)


@token_app.command("remove")
@command
def token_remove(name: TokenUser, tokens: TokensFile = None) -> None:
    """Remove a token. A running server rejects it from the next request onwards."""
    from scope_ptz.cli.serve import remove_token

    remove_token(name, tokens)


# Models and servers ----------------------------------------------------------------------------------------------------
@app.command(rich_help_panel="Measure")
@command
def profile(
    models: ModelFlags,
    pair: Annotated[
        str | None,
        typer.Argument(metavar="PAIR", help="PLANNER+PERCEPTION, or one model that does both; see `scope models pairs`."),
    ] = None,
    instructions: Annotated[
        Path | None, typer.Option("--instructions", help='File of {"instruction", "calls"} lines (default: the packaged 60).')
    ] = None,
    limit: Annotated[int | None, typer.Option("--limit", min=1, help="Use at most N instructions, sampled evenly.")] = None,
    frames: Annotated[int, typer.Option("--frames", min=1, help="Number of frames to send to the perception backend.")] = 6,
    scene: Annotated[str, typer.Option("--scene", help="Scene to take the frames from.")] = DEFAULT_SCENE,
    prompts: Annotated[
        bool, typer.Option("--prompts", help="Also measure how small edits to the prompt and instruction change the tool choice.")
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Measure a planner and a vision model on your own servers: speed, valid calls, and the paper's real-time criterion."""
    from scope_ptz.cli.profile import Workload
    from scope_ptz.cli.profile import profile as run

    workload = Workload(instructions=instructions, limit=limit, frames=frames, scene=scene, edits_prompts=prompts)
    return run(models.options(pair), workload, as_json=as_json)


@app.command(rich_help_panel="Set up")
@command
def doctor(models: PairFlags, as_json: JsonOption = False) -> int:
    """Report what is installed and what is missing. With the address of a model server, check that server instead."""
    from scope_ptz.cli.doctor import check_installation, check_servers

    options = models.options()
    if any((options.pair, options.planner, options.perception, options.planner_url, options.perception_url)):
        return check_servers(options, as_json=as_json)
    return check_installation(as_json=as_json)


@models_app.callback()
@command
def models_list(
    context: typer.Context,
    memory: Annotated[float | None, typer.Option("--memory", min=0.1, help="List only models that fit into N GB.")] = None,
    role: Annotated[str | None, typer.Option("--role", help="List only models for this role: planner or perception.")] = None,
    as_json: JsonOption = False,
) -> None:
    """List the models: the paper's, current ones, and your own (SCOPE_MODELS)."""
    if context.invoked_subcommand is not None:
        return
    from scope_ptz.cli.models import list_models

    list_models(role, memory, as_json=as_json)


@models_app.command("show")
@command
def models_show(name: ModelName, as_json: JsonOption = False) -> None:
    """Print the details of a model, with the command for each server that can run it."""
    from scope_ptz.cli.models import show_model

    show_model(name, as_json=as_json)


@models_app.command("serve-command")
@command
def models_serve(
    name: ModelName,
    server: Annotated[
        str | None, typer.Option("--server", help="Server: vllm, sglang, llama.cpp, ollama, ... (default: the model's first).")
    ] = None,
) -> None:
    """Print the command that serves a model."""
    from scope_ptz.cli.models import serve_command

    serve_command(name, server)


@models_app.command("plugins")
@command
def models_plugins(as_json: JsonOption = False) -> None:
    """List the cameras, planners and perception backends that installed plug-ins add."""
    from scope_ptz.cli.models import list_plugins

    list_plugins(as_json=as_json)


@models_app.command("pairs")
@command
def models_pairs(as_json: JsonOption = False) -> None:
    """List known pairs of a planner and a perception model, including the paper's 19."""
    from scope_ptz.cli.models import list_pairs

    list_pairs(as_json=as_json)
