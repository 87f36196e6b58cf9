"""The commands and their options. Bodies import lazily so that ``scope --help`` is instant."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.builtin_names import DEFAULT_SCENE
from scope_ptz.cli.bench import bench_app
from scope_ptz.cli.endings import ending
from scope_ptz.cli.model_commands import doctor, models_app, profile
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

if TYPE_CHECKING:
    from scope_ptz.cli.asking import Asking
    from scope_ptz.factory.models import ModelOptions

app = typer.Typer(
    help="Talk to a pan-tilt-zoom camera in plain language.",
    epilog="Exit codes: 0 done, 1 the run failed, 2 wrong input or a damaged pack, 130 cancelled.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
scene_app = typer.Typer(help="The scenes: list, show, view, build, bake and verify them.", no_args_is_help=True)
app.add_typer(scene_app, name="scene")
app.add_typer(models_app, name="models")
app.add_typer(bench_app, name="bench")

SceneOption = Annotated[str, typer.Option("--scene", help="Scene to look at; see `scope scene list`.")]
CameraOption = Annotated[
    str | None,
    typer.Option("--camera", help="Camera in place of --scene: blender:SCENE, blender:FILE.blend, or SCHEME:ADDRESS of a plug-in."),
]
ViewpointOption = Annotated[str | None, typer.Option("--viewpoint", help="Where the camera stands.")]
PresetOption = Annotated[str | None, typer.Option("--preset", help="Preset to start at.")]
TimeOption = Annotated[
    float | None, typer.Option("--at", min=0.0, help="Scene time to begin at, in seconds (default: the scene's).")
]
RunsDirOption = Annotated[Path | None, typer.Option("--runs-dir", help="Where run folders are made (default: runs).")]
MaxStepsOption = Annotated[int, typer.Option("--max-steps", min=1, help="Steps after which a run is given up.")]
TimeBudgetOption = Annotated[float | None, typer.Option("--time-budget", min=0.001, help="Wall seconds a run may take.")]
SeedOption = Annotated[int, typer.Option("--seed", help="Seed of everything random.")]
RealtimeOption = Annotated[
    bool | None,
    typer.Option("--realtime/--fast", help="Move in real time, or at once (default: real time on a terminal)."),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")]
Output = Annotated[Path, typer.Option("--out", "-o", help="File to write.")]
SceneName = Annotated[str, typer.Argument(help="Name of the scene.")]
SceneSource = Annotated[str, typer.Argument(help="Name of a built-in scene, or a Python file with `build(stage)`.")]


def _version(wanted: bool) -> None:
    if wanted:
        from scope_ptz.version import __version__

        sys.stdout.write(f"scope-ptz {__version__}\n")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")] = False,
) -> None:
    """Talk to a pan-tilt-zoom camera in plain language."""


def _asking(
    camera: str, viewpoint: str | None, preset: str | None, at: float | None, wishes: ModelOptions, runs_dir: Path | None,
    max_steps: int, time_budget: float | None, realtime: bool | None, seed: int, as_json: bool = False,
) -> Asking:  # fmt: skip
    from scope_ptz.agent.records import Budgets
    from scope_ptz.cli.asking import Asking
    from scope_ptz.settings import load_settings

    return Asking(
        camera=camera,
        viewpoint=viewpoint,
        preset=preset,
        time_s=at,
        wishes=wishes,
        runs_dir=runs_dir or load_settings().runs_dir,
        budgets=Budgets(max_steps=max_steps, time_s=time_budget),
        seed=seed,
        realtime=realtime,
        as_json=as_json,
    )


@app.command()
def ask(
    instruction: Annotated[str, typer.Argument(help="What the camera should do, in plain words.")],
    scene: SceneOption = DEFAULT_SCENE,
    camera: CameraOption = None,
    viewpoint: ViewpointOption = None,
    preset: PresetOption = None,
    at: TimeOption = None,
    planner: PlannerOption = None,
    perception: PerceptionOption = None,
    pair: PairOption = None,
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
    runs_dir: RunsDirOption = None,
    max_steps: MaxStepsOption = 64,
    time_budget: TimeBudgetOption = None,
    realtime: RealtimeOption = None,
    seed: SeedOption = 0,
    as_json: JsonOption = False,
) -> None:
    """Carry out one instruction and keep the run: trace, frames and a filmstrip."""
    with ending(as_json=as_json):
        from scope_ptz.cli.asking import ask as run

        wishes = model_options(
            planner, perception, pair, planner_url, perception_url, planner_model, perception_model, planner_key_file, perception_key_file,
            planner_option, perception_option, reader, detector, timeout,
        )  # fmt: skip
        options = _asking(camera or scene, viewpoint, preset, at, wishes, runs_dir, max_steps, time_budget, realtime, seed, as_json)
        sys.exit(run(instruction, options))


@app.command()
def chat(
    scene: SceneOption = DEFAULT_SCENE,
    camera: CameraOption = None,
    viewpoint: ViewpointOption = None,
    preset: PresetOption = None,
    at: TimeOption = None,
    planner: PlannerOption = None,
    perception: PerceptionOption = None,
    pair: PairOption = None,
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
    runs_dir: RunsDirOption = None,
    max_steps: MaxStepsOption = 64,
    time_budget: TimeBudgetOption = None,
    realtime: RealtimeOption = None,
    seed: SeedOption = 0,
) -> None:
    """Several instructions in one conversation. /pose, /save and /quit do what they say."""
    with ending():
        from scope_ptz.cli.chatting import chat as run

        wishes = model_options(
            planner, perception, pair, planner_url, perception_url, planner_model, perception_model, planner_key_file, perception_key_file,
            planner_option, perception_option, reader, detector, timeout,
        )  # fmt: skip
        options = _asking(camera or scene, viewpoint, preset, at, wishes, runs_dir, max_steps, time_budget, realtime, seed)
        sys.exit(run(options))


@app.command()
def plan(
    instruction: Annotated[str | None, typer.Argument(help="What the camera should do, in plain words.")] = None,
    presets: Annotated[str | None, typer.Option("--presets", help="Preset names, joined by commas.")] = None,
    source: Annotated[Path | None, typer.Option("--from", help='File of {"instruction", "presets"} lines ("-": stdin).')] = None,
    as_json: JsonOption = False,
) -> None:
    """Show which calls an instruction leads to, without moving anything."""
    with ending(as_json=as_json):
        from scope_ptz.cli.planning import plan as run

        sys.exit(run(instruction, presets, source, as_json=as_json))


@app.command()
def replay(
    run_dir: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder, or a trace file.")],
    as_json: JsonOption = False,
) -> None:
    """Repeat a run from its trace, without models, and say whether it came out the same."""
    with ending(as_json=as_json):
        from scope_ptz.cli.replaying import replay as run

        sys.exit(run(run_dir, as_json=as_json))


@app.command()
def tools(
    as_json: Annotated[bool, typer.Option("--json", help="JSON on one line instead of indented.")] = False,
) -> None:
    """Print the tools' schemas in the OpenAI function format."""
    with ending(as_json=as_json):
        from scope_ptz.cli.endings import put_json
        from scope_ptz.tools.registry import schemas

        put_json(schemas(), indent=None if as_json else 2)


app.command()(profile)
app.command()(doctor)


@scene_app.command("list")
def scene_list(as_json: JsonOption = False) -> None:
    """List the scenes that can be loaded."""
    with ending(as_json=as_json):
        from scope_ptz.cli.scenes import list_scenes

        list_scenes(as_json=as_json)


@scene_app.command("show")
def scene_show(
    name: SceneName,
    contact_sheet: Annotated[
        Path | None, typer.Option("--contact-sheet", help="PNG file for the picture of all presets (default: in the cache).")
    ] = None,
    opened: Annotated[
        bool | None, typer.Option("--open/--no-open", help="Open the picture (default: when there is a desktop to see it on).")
    ] = None,
    as_markdown: Annotated[bool, typer.Option("--markdown", help="Print the card as a Markdown page and nothing else.")] = False,
) -> None:
    """Print a scene's card (viewpoints, presets, what is in it and what is not) and open a picture of all presets."""
    with ending():
        from scope_ptz.cli.scenes import show_scene

        show_scene(name, contact_sheet, opened=opened, as_markdown=as_markdown)


@scene_app.command("view")
def scene_view(
    name: SceneName,
    out: Output,
    viewpoint: ViewpointOption = None,
    preset: PresetOption = None,
    at: TimeOption = None,
    pan: Annotated[float | None, typer.Option("--pan", help="Pan in degrees, positive = right.")] = None,
    tilt: Annotated[float | None, typer.Option("--tilt", help="Tilt in degrees, positive = up.")] = None,
    zoom: Annotated[float | None, typer.Option("--zoom", help="Magnification, 1 = widest.")] = None,
) -> None:
    """Write what the camera sees at a pose to a picture file."""
    with ending():
        from scope_ptz.cli.scenes import view_scene

        view_scene(name, viewpoint, preset, at, (pan, tilt, zoom), out)


@scene_app.command("build")
def scene_build(
    name: SceneSource,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Blender file to write (default: NAME.blend).")] = None,
) -> None:
    """Build a scene from its code in Blender and save it as a .blend file."""
    with ending():
        from scope_ptz.cli.baking import build_scene

        build_scene(name, out)


@scene_app.command("bake")
def scene_bake(
    name: SceneSource,
    quality: Annotated[str, typer.Option("--quality", help="draft, standard or high.")] = "standard",
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Scene folder to write (default: scenes/NAME).")] = None,
    viewpoint: Annotated[list[str] | None, typer.Option("--viewpoint", help="Only this viewpoint; may be repeated.")] = None,
) -> None:
    """Render a scene's viewpoints into packs. An interrupted bake goes on where it stopped."""
    with ending():
        from scope_ptz.cli.baking import bake_scene

        sys.exit(bake_scene(name, out, quality, viewpoint or []))


@scene_app.command("verify")
def scene_verify(
    name: SceneName,
    seed: SeedOption = 1,
    wide: Annotated[int, typer.Option("--wide", min=0, help="Poses at the widest zoom, over all tilts.")] = 8,
    zoomed: Annotated[int, typer.Option("--zoomed", min=0, help="Poses at 2x to 5x, where the pack has tiles.")] = 8,
    keep: Annotated[Path | None, typer.Option("--keep", help="Folder to keep the live renders in.")] = None,
) -> None:
    """Compare a scene's packs with live Blender renders of the same poses."""
    with ending():
        from scope_ptz.cli.baking import verify_scene

        sys.exit(verify_scene(name, seed, wide, zoomed, keep))
