"""Options shared by several commands: single options, and groups of options for cameras, models, judges and servers.

To include a group in a command, annotate a parameter with its dataclass; see ``scope_ptz.cli.typer_extensions``.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.factory.cameras import OpenCamera
    from scope_ptz.factory.models import ModelOptions

CAMERA_PANEL, RUN_PANEL, MODEL_PANEL, JUDGE_PANEL = "Camera", "Run", "Models", "Judge"

JsonOption = Annotated[bool, typer.Option("--json", help="Print only JSON.")]
SeedOption = Annotated[int, typer.Option("--seed", help="Seed for every random choice.")]
RunSeedOption = Annotated[int, typer.Option("--seed", help="Seed for every random choice.", rich_help_panel=RUN_PANEL)]
PortOption = Annotated[int, typer.Option("--port", min=0, max=65535, help="Port to listen on; 0 for any free one.")]
OutputFile = Annotated[Path, typer.Option("--out", "-o", help="File to write.")]


@dataclass(frozen=True, kw_only=True)
class StartFlags:
    """Options that select the camera, its start pose and its start time."""

    camera: Annotated[
        str | None,
        typer.Option(
            "--camera",
            metavar="SPEC",
            help="Camera: a name in scope.yaml, sim:SCENE, axis://USER@HOST, onvif://USER@HOST, blender:SCENE, blender:FILE.blend, "
            "or a plug-in's camera (default: sim:highway-works).",
            rich_help_panel=CAMERA_PANEL,
        ),
    ] = None
    scene: Annotated[
        str | None,
        typer.Option("--scene", help="Scene: short for --camera sim:SCENE; see `scope scene list`.", rich_help_panel=CAMERA_PANEL),
    ] = None
    viewpoint: Annotated[
        str | None,
        typer.Option("--viewpoint", help="Viewpoint to start at (default: the scene's home).", rich_help_panel=CAMERA_PANEL),
    ] = None
    preset: Annotated[
        str | None,
        typer.Option("--preset", help="Preset to start at (default: the scene's home).", rich_help_panel=CAMERA_PANEL),
    ] = None
    at: Annotated[
        float | None,
        typer.Option(
            "--at", min=0.0, help="Scene time to start at, in seconds (default: set by the scene).", rich_help_panel=CAMERA_PANEL
        ),
    ] = None

    async def open(self, *, realtime: bool = False, dry_run: Callable[[str], None] | None = None) -> OpenCamera:
        """Open the camera at the selected viewpoint, preset and time.

        Args:
            realtime: Whether moves take as long as with a real camera.
            dry_run: Function that gets a sentence about each command, which is then not executed; None for no dry run.
        """
        from scope_ptz.builtin_names import DEFAULT_SCENE
        from scope_ptz.factory.cameras import open_camera

        if self.camera is not None and self.scene is not None:
            raise InputError("Give either --camera or --scene, not both: --scene NAME is short for --camera sim:NAME.")
        spec = self.camera or f"sim:{DEFAULT_SCENE if self.scene is None else self.scene}"
        return await open_camera(
            spec, viewpoint=self.viewpoint, preset=self.preset, time_s=self.at, realtime=realtime, dry_run=dry_run
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class SessionFlags(StartFlags):
    """Options for the camera, its start pose and time, and the limits of runs."""

    realtime: Annotated[
        bool | None,
        typer.Option(
            "--realtime/--fast",
            help="Move in real time or instantly (default: real time on a terminal).",
            rich_help_panel=CAMERA_PANEL,
        ),
    ] = None
    dry_run: Annotated[
        bool,
        typer.Option(
            "--dry-run",
            help="Report the moves without moving the camera. Every frame shows the start view.",
            rich_help_panel=CAMERA_PANEL,
        ),
    ] = False
    runs_dir: Annotated[
        Path | None,
        typer.Option("--runs-dir", help="Folder for run folders (default: SCOPE_RUNS_DIR, or runs).", rich_help_panel=RUN_PANEL),
    ] = None
    max_steps: Annotated[
        int, typer.Option("--max-steps", min=1, help="Maximum number of planner steps.", rich_help_panel=RUN_PANEL)
    ] = 64
    time_budget: Annotated[
        float | None,
        typer.Option(
            "--time-budget",
            min=0.001,
            help="Maximum wall-clock time of a run in seconds (default: no limit).",
            rich_help_panel=RUN_PANEL,
        ),
    ] = None
    seed: RunSeedOption = 0

    def in_real_time(self, *, as_json: bool = False) -> bool:
        """Return whether to move in real time: as requested or, by default, if the output is a terminal."""
        return self.realtime if self.realtime is not None else sys.stdout.isatty() and not as_json


@dataclass(frozen=True, kw_only=True)
class ModelFlags:
    """Options for the planner, perception, and their servers."""

    planner: Annotated[
        str | None,
        typer.Option(
            "--planner",
            help="Planner: grammar (default), chat, a model, hybrid:MODEL, or a plug-in; see `scope models`.",
            rich_help_panel=MODEL_PANEL,
        ),
    ] = None
    perception: Annotated[
        str | None,
        typer.Option(
            "--perception",
            help="Perception: ground-truth (default), noisy, simulation-only-truth, a model, a backend, or a plug-in.",
            rich_help_panel=MODEL_PANEL,
        ),
    ] = None
    planner_url: Annotated[
        str | None,
        typer.Option(
            "--planner-url",
            help="Address of the planner's server, ending in /v1 (or SCOPE_PLANNER_URL).",
            rich_help_panel=MODEL_PANEL,
        ),
    ] = None
    perception_url: Annotated[
        str | None,
        typer.Option(
            "--perception-url", help="Address of the perception server (or SCOPE_PERCEPTION_URL).", rich_help_panel=MODEL_PANEL
        ),
    ] = None
    planner_model: Annotated[
        str | None,
        typer.Option(
            "--planner-model", help="Name of the planner on its server (default: the one it lists).", rich_help_panel=MODEL_PANEL
        ),
    ] = None
    perception_model: Annotated[
        str | None,
        typer.Option(
            "--perception-model",
            help="Name of the vision model on its server (default: the one it lists).",
            rich_help_panel=MODEL_PANEL,
        ),
    ] = None
    planner_key_file: Annotated[
        Path | None,
        typer.Option(
            "--planner-key-file",
            help="File with the key of the planner's server (or SCOPE_PLANNER_KEY).",
            rich_help_panel=MODEL_PANEL,
        ),
    ] = None
    perception_key_file: Annotated[
        Path | None,
        typer.Option(
            "--perception-key-file",
            help="File with the key of the perception server (or SCOPE_PERCEPTION_KEY).",
            rich_help_panel=MODEL_PANEL,
        ),
    ] = None
    planner_option: Annotated[
        list[str] | None,
        typer.Option(
            "--planner-option",
            metavar="NAME=VALUE",
            help="Planner setting: thinking=on, prompt=..., summarise=true, ... (repeatable).",
            rich_help_panel=MODEL_PANEL,
        ),
    ] = None
    perception_option: Annotated[
        list[str] | None,
        typer.Option(
            "--perception-option",
            metavar="NAME=VALUE",
            help="Perception setting: coordinates=qwen3-vl, max_pixels=..., ... (repeatable).",
            rich_help_panel=MODEL_PANEL,
        ),
    ] = None
    reader: Annotated[
        str | None,
        typer.Option("--reader", help="Separate backend for reading text, for example rapidocr.", rich_help_panel=MODEL_PANEL),
    ] = None
    detector: Annotated[
        str | None,
        typer.Option(
            "--detector", help="Separate backend for finding objects, for example owlv2-base.", rich_help_panel=MODEL_PANEL
        ),
    ] = None
    timeout: Annotated[
        float | None,
        typer.Option(
            "--timeout",
            min=0.1,
            help="Timeout in seconds for a request to a model server, including retries.",
            rich_help_panel=MODEL_PANEL,
        ),
    ] = None

    def options(self, pair: str | None = None) -> ModelOptions:
        """Convert the flags to options for ``factory.models.resolve_models``.

        Args:
            pair: Name of a pair, for commands that take it as an argument.
        """
        from scope_ptz.factory.models import ModelOptions

        return ModelOptions(
            planner=self.planner,
            perception=self.perception,
            pair=pair,
            planner_url=self.planner_url,
            perception_url=self.perception_url,
            planner_model=self.planner_model,
            perception_model=self.perception_model,
            planner_key_file=self.planner_key_file,
            perception_key_file=self.perception_key_file,
            planner_options=tuple(self.planner_option or ()),
            perception_options=tuple(self.perception_option or ()),
            reader=self.reader,
            detector=self.detector,
            timeout_s=self.timeout,
        )


@dataclass(frozen=True, kw_only=True)
class _PairFlag:
    pair: Annotated[
        str | None,
        typer.Option(
            "--pair",
            help="Planner and perception together: PLANNER+PERCEPTION, or one model that does both; see `scope models pairs`.",
            rich_help_panel=MODEL_PANEL,
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class PairFlags(ModelFlags, _PairFlag):
    """The options of ``ModelFlags``, preceded by ``--pair`` in the help."""

    def options(self, pair: str | None = None) -> ModelOptions:
        """Convert the flags to options for ``factory.models.resolve_models``."""
        return super().options(pair or self.pair)


@dataclass(frozen=True, kw_only=True)
class JudgeFlags:
    """Options for the judge and its server."""

    judge_url: Annotated[
        str | None,
        typer.Option(
            "--judge-url", help="Address of the judge's server, ending in /v1 (or SCOPE_JUDGE_URL).", rich_help_panel=JUDGE_PANEL
        ),
    ] = None
    judge_model: Annotated[
        str | None,
        typer.Option(
            "--judge-model",
            help="Name of the judge model on its server (or SCOPE_JUDGE_MODEL; default: gpt-oss-120b, else the only one it lists).",
            rich_help_panel=JUDGE_PANEL,
        ),
    ] = None
    judge_key_file: Annotated[
        Path | None,
        typer.Option(
            "--judge-key-file", help="File with the key of the judge's server (or SCOPE_JUDGE_KEY).", rich_help_panel=JUDGE_PANEL
        ),
    ] = None
    judge_timeout: Annotated[
        float,
        typer.Option(
            "--judge-timeout", min=0.1, help="Timeout in seconds for a judgement, including retries.", rich_help_panel=JUDGE_PANEL
        ),
    ] = 300.0
    judge_option: Annotated[
        list[str] | None,
        typer.Option(
            "--judge-option",
            metavar="NAME=VALUE",
            help="Judge setting: temperature=0, seed=1, reasoning_effort=high, ... (repeatable).",
            rich_help_panel=JUDGE_PANEL,
        ),
    ] = None


TokensFile = Annotated[Path | None, typer.Option("--tokens", help="File with the tokens (default: SCOPE_TOKENS).")]


@dataclass(frozen=True, kw_only=True)
class ServerFlags:
    """Options for a server: what to serve, where to listen, and what to do with unused cameras."""

    cameras: Annotated[
        list[str] | None, typer.Option("--camera", help="Camera in scope.yaml, or scene, to serve (default: all; repeatable).")
    ] = None
    pair: Annotated[
        list[str] | None, typer.Option("--pair", help="Pair of models to offer, the default first; see `scope models pairs`.")
    ] = None
    host: Annotated[str, typer.Option("--host", help="Address to listen on. Addresses other than loopback need tokens.")] = (
        "127.0.0.1"
    )
    port: PortOption = 8000
    name: Annotated[
        list[str] | None, typer.Option("--name", help="Additional host name of the server, such as that of a proxy (repeatable).")
    ] = None
    tokens: TokensFile = None
    runs_dir: Annotated[Path | None, typer.Option("--runs-dir", help="Folder for the runs (default: SCOPE_RUNS_DIR).")] = None
    idle_after: Annotated[
        float | None, typer.Option("--idle-after", min=1.0, help="Return an unused camera to a preset after N seconds.")
    ] = None
    idle_preset: Annotated[str, typer.Option("--idle-preset", help="Preset to which unused cameras return (default: home).")] = ""
    until_eof: Annotated[
        bool, typer.Option("--until-eof", help="Exit when standard input is closed, for programs that start the server.")
    ] = False
