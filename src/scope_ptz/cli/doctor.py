"""``scope doctor``: what is installed, reachable and missing, and how to get it."""

from __future__ import annotations

import os
import platform
import re
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import Literal

from rich.console import Console
from rich.text import Text

from scope_ptz.builtin_names import DEFAULT_SCENE
from scope_ptz.cli.cards import folder_bytes
from scope_ptz.cli.endings import FAILED, put_json
from scope_ptz.errors import PackError
from scope_ptz.factory.scenes import open_scene, scene_search
from scope_ptz.settings import ScopeSettings, load_settings
from scope_ptz.version import __version__

Verdict = Literal["ok", "optional", "missing"]
_MARKS: dict[Verdict, tuple[str, str]] = {"ok": ("ok", "green"), "optional": ("--", "yellow"), "missing": ("!!", "bold red")}


@dataclass(frozen=True, slots=True)
class Finding:
    """``optional``: not there and not needed for the demo; ``missing``: something does not work without it."""

    what: str
    verdict: Verdict
    detail: str
    remedy: str = ""


def doctor(*, as_json: bool) -> int:
    """Print all findings; exit code 1 when something needed is missing."""
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
    """Everything worth knowing when something does not work."""
    yield Finding("scope-ptz", "ok", f"{__version__} in {Path(__file__).parents[1]}")
    enough = sys.version_info >= (3, 11)
    yield Finding(
        "Python", "ok" if enough else "missing", platform.python_version(), "" if enough else "Install Python 3.11 or later."
    )
    yield _packages()
    yield from _scenes(settings)
    yield _runs_dir(settings.runs_dir)
    yield _blender(settings)
    yield from _plugins()


def _plugins() -> Iterator[Finding]:
    """What each installed plug-in does when it is loaded and tried."""
    import anyio

    from scope_ptz.factory.plugin_checks import check_plugin
    from scope_ptz.factory.plugins import list_plugins

    for plugin in list_plugins():
        check = anyio.run(check_plugin, plugin)
        verdict: Verdict = {"ok": "ok", "partly": "optional", "failed": "missing"}[check.verdict]  # type: ignore[assignment]
        remedy = f"Update {plugin.package}, or uninstall it." if check.verdict == "failed" else ""
        yield Finding(f"{plugin.kind} {plugin.name}", verdict, f"plug-in of {plugin.package}: {check.detail}", remedy)


def _packages() -> Finding:
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
        return Finding("packages", "missing", f"missing: {', '.join(missing)}", "Run `pip install -r requirements/base.txt`.")
    return Finding("packages", "ok", ", ".join(found))


def _scenes(settings: ScopeSettings) -> Iterator[Finding]:
    from scope_ptz.simulator.pack import find_scenes

    scenes = find_scenes(scene_search(settings))
    if settings.scenes_dir is not None and not settings.scenes_dir.is_dir():
        yield Finding("SCOPE_SCENES_DIR", "missing", f"{settings.scenes_dir} is no folder", "Correct the variable, or unset it.")
    for name, folder in scenes.items():
        try:
            files = _verify(name)
        except PackError as error:
            yield Finding(f"scene {name}", "missing", str(error), f"Restore {folder}, or bake it again: scope scene bake {name}")
        else:
            yield Finding(f"scene {name}", "ok", f"{files} files match their checksums, {folder_bytes(folder) / 1e6:.1f} MB")
    if DEFAULT_SCENE not in scenes:
        yield Finding(f"scene {DEFAULT_SCENE}", "missing", "not found", f"Reinstall, or bake it: scope scene bake {DEFAULT_SCENE}")


def _verify(name: str) -> int:
    """Check every file of a scene against its manifest; the number of files. Raises ``PackError``."""
    scene = open_scene(name)
    return sum(scene.viewpoint(place.name).check_files() for place in scene.file.viewpoints)


def _runs_dir(path: Path) -> Finding:
    existing = next(folder for folder in (path, *path.absolute().parents) if folder.exists())
    if existing.is_dir() and os.access(existing, os.W_OK):
        return Finding("run folders", "ok", f"{path.absolute()} can be written")
    return Finding("run folders", "missing", f"{path.absolute()} cannot be written", "Set SCOPE_RUNS_DIR, or give --runs-dir.")


def _blender(settings: ScopeSettings) -> Finding:
    from scope_ptz.blender.environment import BPY_VERSION, environment_python, is_ready

    chosen = settings.blender_python or settings.blender
    if chosen is not None:
        there = chosen.exists()
        remedy = "" if there else "Correct SCOPE_BLENDER_PYTHON or SCOPE_BLENDER."
        return Finding("Blender", "ok" if there else "missing", f"{chosen}{'' if there else ' does not exist'}", remedy)
    if is_ready(settings.cache_dir):
        return Finding("Blender", "ok", f"bpy {BPY_VERSION} in {environment_python(settings.cache_dir).parents[1]}")
    return Finding(
        "Blender", "optional", "not installed; only `scope scene build` and `scope scene bake` need it",
        "They install it by themselves (about 400 MB), or set SCOPE_BLENDER to your own blender program.",
    )  # fmt: skip
