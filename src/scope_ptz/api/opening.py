"""``open`` and ``open_async``, which create a session."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from scope_ptz.agent.records import Budgets
from scope_ptz.api.async_scope import AsyncScope
from scope_ptz.api.options import ModelServerOptions, SessionOptions, StrPath
from scope_ptz.api.scope import Scope
from scope_ptz.api.sessions import new_session
from scope_ptz.builtin_names import DEFAULT_SCENE
from scope_ptz.camera.base import Camera
from scope_ptz.errors import InputError
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import Planner


def open(  # noqa: A001 - the public name, used as scope_ptz.open
    camera: Camera | str = DEFAULT_SCENE,
    *,
    planner: Planner | str | None = None,
    perception: Perception | str | None = None,
    pair: str | None = None,
    viewpoint: str | None = None,
    preset: str | None = None,
    time_s: float | None = None,
    seed: int = 0,
    realtime: bool = False,
    dry_run: bool = False,
    runs_dir: StrPath | None = None,
    max_steps: int = 60,
    time_budget_s: float | None = None,
    token_budget: int | None = None,
    planner_url: str | None = None,
    planner_model: str | None = None,
    planner_key_file: StrPath | None = None,
    planner_options: Mapping[str, Any] | None = None,
    perception_url: str | None = None,
    perception_model: str | None = None,
    perception_key_file: StrPath | None = None,
    perception_options: Mapping[str, Any] | None = None,
    reader: str | None = None,
    detector: str | None = None,
    timeout_s: float | None = None,
) -> Scope:
    """Open a session with a camera.

    By default, the planner is the built-in rule-based one and perception is the simulator's ground truth. They need no model, key
    or network. A camera without ground truth has no perception unless you choose one: it can move and take frames, but questions
    about what it sees raise ``PerceptionError``.

    Args:
        camera: A scene ("highway-works"), any other camera spec ("blender:yard.blend"), a ``Camera`` object, or a camera on a
            ``scope serve`` server ("http://host:8000/yard-gate"). The planner and perception then run on the server, and the
            only other options are ``pair`` and ``preset``. The server's token is read from the environment variable SCOPE_TOKEN.
        planner: Name of a planner or model ("grammar", "qwen3-4b"), or a ``Planner`` object.
        perception: Name of a backend or model ("ground-truth", "noisy", "moondream3"), or a ``Perception`` object.
        pair: A pair as "PLANNER+PERCEPTION", or the name of one model that does both.
        viewpoint: The camera's viewpoint in the scene; by default, the viewpoint of the home preset.
        preset: The preset to start at. It determines the viewpoint, so pass only one of the two.
        time_s: Scene time at the start, in seconds; the scene's own start time by default.
        seed: Seed for every random choice.
        realtime: Whether moves take as long as those of a real camera, and scene time follows the wall clock.
        dry_run: Plan and report moves without making them. Every frame shows the initial view, and results of moves state this.
        runs_dir: Folder in which each run creates a folder with its trace and pictures; by default, runs stay in memory.
        max_steps: Number of planner steps after which a run ends.
        time_budget_s: Seconds of wall-clock time after which a run ends; no limit by default.
        token_budget: Number of planner tokens after which a run ends; no limit by default.
        planner_url: Address of the planner's model server.
        planner_model: Name of the planner's model on its server.
        planner_key_file: File that contains the API key of the planner's server.
        planner_options: Additional options of the planner, such as ``{"temperature": 0.2}``.
        perception_url: Address of the vision model's server.
        perception_model: Name of the vision model on its server.
        perception_key_file: File that contains the API key of the vision model's server.
        perception_options: Additional options of the perception backend.
        reader: Name of an additional backend that reads text.
        detector: Name of an additional backend that detects objects.
        timeout_s: Seconds after which a request to a model server fails, including its retries.

    Returns:
        An open session. Use it in a ``with`` statement, or call ``close`` at the end.

    Raises:
        InputError: An option is invalid, or a name is unknown.
        PackError: The files of a scene are damaged.
        CameraError: The camera failed or did not answer.
        BlenderError: Blender cannot be started, or cannot open the scene or the file.

    Example:
        >>> import scope_ptz
        >>> with scope_ptz.open("highway-works", preset="gate") as scope:
        ...     run = scope.ask("how many cones are there?")
        >>> run.ok
        True
    """
    return Scope(_session_options(**locals()))


def open_async(
    camera: Camera | str = DEFAULT_SCENE,
    *,
    planner: Planner | str | None = None,
    perception: Perception | str | None = None,
    pair: str | None = None,
    viewpoint: str | None = None,
    preset: str | None = None,
    time_s: float | None = None,
    seed: int = 0,
    realtime: bool = False,
    dry_run: bool = False,
    runs_dir: StrPath | None = None,
    max_steps: int = 60,
    time_budget_s: float | None = None,
    token_budget: int | None = None,
    planner_url: str | None = None,
    planner_model: str | None = None,
    planner_key_file: StrPath | None = None,
    planner_options: Mapping[str, Any] | None = None,
    perception_url: str | None = None,
    perception_model: str | None = None,
    perception_key_file: StrPath | None = None,
    perception_options: Mapping[str, Any] | None = None,
    reader: str | None = None,
    detector: str | None = None,
    timeout_s: float | None = None,
) -> AsyncScope:
    """Create a session for asynchronous code. The arguments are the same as those of ``open``, which describes them.

    Returns:
        A session that is not open yet. Use it in an ``async with`` statement, or await it and call ``close`` at the end.

    Raises:
        InputError: An option is invalid. The other errors of ``open`` are raised by ``async with`` or ``await``.

    Example:
        >>> import asyncio, scope_ptz
        >>> async def main():
        ...     async with scope_ptz.open_async("highway-works") as scope:
        ...         print((await scope.ask("zoom in 2x")).pose.zoom)
        >>> asyncio.run(main())
        2.0
    """
    return new_session(_session_options(**locals()))


def _session_options(
    *,
    camera: Camera | str,
    planner: Planner | str | None,
    perception: Perception | str | None,
    viewpoint: str | None,
    preset: str | None,
    time_s: float | None,
    seed: int,
    realtime: bool,
    dry_run: bool,
    runs_dir: StrPath | None,
    max_steps: int,
    time_budget_s: float | None,
    token_budget: int | None,
    **served: Any,
) -> SessionOptions:
    try:
        budgets = Budgets(max_steps=max_steps, time_s=time_budget_s, tokens=token_budget)
    except ValidationError as error:
        names = {"time_s": "time_budget_s", "tokens": "token_budget"}
        first = error.errors(include_url=False)[0]
        field = str(first["loc"][0])
        raise InputError(f"{names.get(field, field)} is invalid: {first['msg']}.") from None
    return SessionOptions(
        camera=camera,
        planner=planner,
        perception=perception,
        served=ModelServerOptions(**served),
        viewpoint=viewpoint,
        preset=preset,
        time_s=time_s,
        seed=seed,
        realtime=realtime,
        dry_run=dry_run,
        runs_dir=None if runs_dir is None else Path(runs_dir),
        budgets=budgets,
    )
