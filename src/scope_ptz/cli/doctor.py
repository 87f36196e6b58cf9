"""``scope doctor``: report what is installed and what is missing, or check that a model server meets SCOPE's requirements."""

from __future__ import annotations

import os
import platform
import re
import sys
from collections.abc import AsyncIterator, Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import anyio
from rich.console import Console
from rich.text import Text

from scope_ptz.builtin_names import DEFAULT_SCENE
from scope_ptz.cli.display import sanitize
from scope_ptz.cli.exit import FAILED, put_json, run_async
from scope_ptz.errors import ConfigError, InputError, PackError
from scope_ptz.factory.cameras import open_camera
from scope_ptz.factory.models import ModelOptions, make_perception, resolve_models
from scope_ptz.factory.scenes import scene_search
from scope_ptz.settings import ScopeSettings, load_settings
from scope_ptz.simulator.card import folder_bytes, megabytes
from scope_ptz.version import __version__

if TYPE_CHECKING:
    from scope_ptz.endpoints.chat_server_checks import ServerCheck
    from scope_ptz.factory.models import ResolvedPerception, ResolvedPlanner

Verdict = Literal["ok", "optional", "missing"]
_OK, _PARTIAL, _BAD = ("ok", "green"), ("--", "yellow"), ("!!", "bold red")
_MARKS: dict[str, tuple[str, str]] = {"ok": _OK, "optional": _PARTIAL, "missing": _BAD, "partly": _PARTIAL, "failed": _BAD}
_EXAMPLE_OBJECT, _EXAMPLE_PRESET = "traffic cone", "highway"  # the default scene shows this object at this preset


@dataclass(frozen=True, slots=True)
class Finding:
    """The result of one check of the installation.

    Attributes:
        what: What was checked.
        verdict: ``ok``; ``optional`` for an absent part that only some commands need; ``missing`` for a required part that is
            absent or broken.
        detail: What was found.
        remedy: How to fix it, if necessary.
    """

    what: str
    verdict: Verdict
    detail: str
    remedy: str = ""


def check_installation(*, as_json: bool) -> int:
    """Check the installation, print the findings, and return the exit code, which is 1 if a required part is missing."""
    findings = list(examine(load_settings()))
    if as_json:
        put_json([asdict(finding) for finding in findings])
    else:
        console = Console(highlight=False)
        for finding in findings:
            mark, style = _MARKS[finding.verdict]
            console.print(Text.assemble((f"{mark}  ", style), (f"{finding.what:22}", "bold"), finding.detail), soft_wrap=True)
            if finding.remedy:
                console.print(Text(f"      {finding.remedy}", style=style), soft_wrap=True)
    return FAILED if any(f.verdict == "missing" for f in findings) else 0


def examine(settings: ScopeSettings) -> Iterator[Finding]:
    """Check Python, packages, scenes, the runs folder, Blender and plug-ins, and yield the findings."""
    yield Finding("scope-ptz", "ok", f"{__version__} in {Path(__file__).parents[1]}")
    is_supported = sys.version_info >= (3, 11)
    yield Finding(
        "Python",
        "ok" if is_supported else "missing",
        platform.python_version(),
        "" if is_supported else "Install Python 3.11 or later.",
    )
    yield _check_packages()
    yield from _check_scenes(settings)
    yield _check_runs_dir(settings.runs_dir)
    yield _check_blender(settings)
    yield from _check_plugins()


def _check_plugins() -> Iterator[Finding]:
    """Load and test each installed plug-in."""
    from scope_ptz.factory.plugin_checks import check_plugin
    from scope_ptz.factory.plugins import list_plugins

    verdicts: dict[str, Verdict] = {"ok": "ok", "partly": "optional", "failed": "missing"}
    for plugin in list_plugins():
        check = anyio.run(check_plugin, plugin)
        remedy = f"Update {plugin.package}, or uninstall it." if check.verdict == "failed" else ""
        yield Finding(
            f"{plugin.kind} {plugin.name}", verdicts[check.verdict], f"plug-in of {plugin.package}: {check.detail}", remedy
        )


def _check_packages() -> Finding:
    try:
        needed = [r for r in requires("scope-ptz") or [] if "extra ==" not in r]
    except PackageNotFoundError:
        return Finding("packages", "missing", "scope-ptz itself is not installed", "Run `make demo`, or `pip install -e .`.")
    missing, found = [], []
    for requirement in needed:
        name = re.split(r"[^A-Za-z0-9._-]", requirement, maxsplit=1)[0]
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            missing.append(name)
    if missing:
        return Finding("packages", "missing", f"not installed: {', '.join(missing)}", "Run `pip install -r requirements/base.txt`.")
    return Finding("packages", "ok", ", ".join(found))


def _check_scenes(settings: ScopeSettings) -> Iterator[Finding]:
    from scope_ptz.simulator.pack import find_scenes, load_scene

    folders: tuple[Path, ...] = ()
    try:
        folders = scene_search(settings)
    except ConfigError as error:
        yield Finding("SCOPE_SCENES_DIR", "missing", f"{settings.scenes_dir} is not a folder", str(error))
    scenes = find_scenes(folders)
    for name, folder in scenes.items():
        try:
            scene = load_scene(name, folders)
            files = sum(scene.viewpoint(viewpoint.name).check_files() for viewpoint in scene.file.viewpoints)
        except PackError as error:
            yield Finding(f"scene {name}", "missing", str(error), f"Restore {folder}, or bake it again: scope scene bake {name}")
        else:
            yield Finding(f"scene {name}", "ok", f"{files} files match their checksums, {megabytes(folder_bytes(folder))}")
    if DEFAULT_SCENE not in scenes:
        yield Finding(f"scene {DEFAULT_SCENE}", "missing", "not found", f"Reinstall, or bake it: scope scene bake {DEFAULT_SCENE}")


def _check_runs_dir(path: Path) -> Finding:
    existing = next(folder for folder in (path, *path.absolute().parents) if folder.exists())
    if existing.is_dir() and os.access(existing, os.W_OK):
        return Finding("run folders", "ok", f"{path.absolute()} is writable")
    return Finding("run folders", "missing", f"{path.absolute()} is not writable", "Set SCOPE_RUNS_DIR, or give --runs-dir.")


def _check_blender(settings: ScopeSettings) -> Finding:
    from scope_ptz.blender.environment import BPY_VERSION, environment_python, is_ready

    configured = settings.blender_python or settings.blender
    if configured is not None:
        exists = configured.exists()
        remedy = "" if exists else "Correct SCOPE_BLENDER_PYTHON or SCOPE_BLENDER."
        return Finding("Blender", "ok" if exists else "missing", f"{configured}{'' if exists else ' does not exist'}", remedy)
    if is_ready(settings.cache_dir):
        return Finding("Blender", "ok", f"bpy {BPY_VERSION} in {environment_python(settings.cache_dir).parents[1]}")
    return Finding(
        "Blender", "optional", "not installed; only `scope scene build` and `scope scene bake` need it",
        "The first use downloads it (about 400 MB). To use your own blender program, set SCOPE_BLENDER.",
    )  # fmt: skip


def check_servers(options: ModelOptions, *, as_json: bool) -> int:
    """Check the model servers, print each result, and return the exit code, which is 1 if any check failed."""
    results: list[tuple[str, ServerCheck]] = []
    console = Console(highlight=False)

    async def work() -> None:
        resolved = await resolve_models(options)
        if resolved.planner.endpoint is None and resolved.perception.spec is None:
            raise InputError("There is no server to check. Give one with --planner-url, or with --perception and --perception-url.")
        async for server, check in _server_checks(resolved.planner, resolved.perception):
            results.append((server, check))
            if not as_json:
                _show_check(console, server, check)

    run_async(work)
    if as_json:
        put_json([{"server": server, **check.model_dump()} for server, check in results])
    return FAILED if any(check.verdict == "failed" for _, check in results) else 0


async def _server_checks(planner: ResolvedPlanner, perception: ResolvedPerception) -> AsyncIterator[tuple[str, ServerCheck]]:
    """Run the server checks, and yield the name of the server and the result of each check."""
    if planner.endpoint is not None:
        from scope_ptz.endpoints.chat_server_checks import UNKNOWN_MODEL_CHECK, check_chat
        from scope_ptz.planner.chat.planning_checks import check_planning
        from scope_ptz.tools.registry import schemas

        server, completed = f"planner {planner.name}".strip(), False
        async for check in check_chat(planner.endpoint):
            completed = check.what == UNKNOWN_MODEL_CHECK  # the last check; an unreachable server does not get this far
            yield server, check
        if completed:
            async for check in check_planning(planner.endpoint, schemas(), planner.options):
                yield server, check
    if perception.spec is not None:
        from scope_ptz.perception.models.vision_checks import check_perception

        backend = make_perception(perception, None, 0)
        try:
            async with await open_camera(f"sim:{DEFAULT_SCENE}", preset=_EXAMPLE_PRESET) as opened:
                async for check in check_perception(backend, await opened.camera.frame(), thing=_EXAMPLE_OBJECT):
                    yield f"perception {perception.name}", check
        finally:
            await backend.close()


def _show_check(console: Console, server: str, check: ServerCheck) -> None:
    mark, style = _MARKS[check.verdict]
    head = Text.assemble((f"{mark}  ", style), (f"{sanitize(server)}: {check.what}", "bold"), (f"  {check.seconds:.2f} s  ", "dim"))
    console.print(head + Text(sanitize(check.detail)), soft_wrap=True)
