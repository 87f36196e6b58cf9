"""The source files from which a scene is built. A bake depends only on these files."""

from __future__ import annotations

import ast
import importlib.util
from hashlib import sha256
from pathlib import Path

from scope_ptz.errors import BlenderError, UnknownNameError

PACKAGE = "scope_studio"


def studio_folder() -> Path:
    """Return the ``scope_studio`` package's folder without importing the package.

    Raises:
        BlenderError: The package is not installed.
    """
    spec = importlib.util.find_spec(PACKAGE)
    if spec is None or not spec.submodule_search_locations:
        raise BlenderError(
            "scope-studio is not installed. Building and rendering scenes needs it: install it together with scope-ptz."
        )
    return Path(next(iter(spec.submodule_search_locations)))


def scene_key(source: str) -> str:
    """Return a key for the current version of a scene's code: the scene's name and a digest.

    The digest covers the scene's module and every ``scope_studio`` module that it imports, directly or indirectly.
    """
    scene_module = scene_file(source)
    digest = sha256()
    for path in [scene_module, *sorted(_imported_modules(scene_module))]:
        digest.update(path.read_bytes())
    name = scene_module.parent.name if scene_module.name == "__init__.py" else scene_module.stem
    return f"{name.replace('_', '-')}-{digest.hexdigest()[:12]}"


def scene_file(source: str) -> Path:
    """Return a scene's Python file, which need not exist.

    Args:
        source: A path that ends in ``.py``, or the name of a built-in scene.
    """
    if source.endswith(".py"):
        return Path(source)
    module = studio_folder() / "scenes" / source.replace("-", "_")
    single = module.with_suffix(".py")
    return single if single.is_file() else module / "__init__.py"


def scene_names() -> list[str]:
    """Return the names of the scenes that can be built from code."""
    return sorted(f.parent.name.replace("_", "-") for f in (studio_folder() / "scenes").glob("*/__init__.py"))


def check_scene_name(source: str) -> None:
    """Check that a scene can be built from code, for a clear error before Blender starts.

    Raises:
        UnknownNameError: ``source`` is neither an existing Python file nor the name of a built-in scene.
    """
    if source.endswith(".py") and Path(source).is_file():
        return
    known = scene_names()
    if source not in known:
        raise UnknownNameError("scene", source, known)


def _imported_modules(start: Path) -> set[Path]:
    """Return the ``scope_studio`` modules that a file imports, directly or indirectly, without the file itself."""
    found: set[Path] = set()
    waiting = [start]
    while waiting:
        for path in _imports(waiting.pop()):
            if path not in found and path != start:
                found.add(path)
                waiting.append(path)
    return found


def _imports(path: Path) -> set[Path]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return {file for name in names if (file := _module(name)) is not None}


def _module(name: str) -> Path | None:
    if not name.startswith(PACKAGE + "."):
        return None
    path = studio_folder().joinpath(*name.removeprefix(PACKAGE + ".").split("."))
    return next((p for p in (path.with_suffix(".py"), path / "__init__.py") if p.is_file()), None)
