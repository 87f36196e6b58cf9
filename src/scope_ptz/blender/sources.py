"""What a scene is built from: the modules of the studio that its code imports, so that a bake depends on those and on no others."""

from __future__ import annotations

import ast
from hashlib import sha256
from pathlib import Path

PACKAGE = "scope_ptz.studio"
STUDIO = Path(__file__).resolve().parents[1] / "studio"


def scene_key(source: str) -> str:
    """A name for the present state of a scene's code: its own module and everything in the studio that it imports, however far."""
    own = Path(source) if source.endswith(".py") else STUDIO / "scenes" / f"{source.replace('-', '_')}.py"
    digest = sha256()
    for path in [own, *sorted(_reach(own))]:
        digest.update(path.read_bytes())
    return f"{own.stem.replace('_', '-')}-{digest.hexdigest()[:12]}"


def _reach(start: Path) -> set[Path]:
    """Studio modules imported by a file, directly or through one another; without the file itself."""
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
    place = STUDIO.joinpath(*name.removeprefix(PACKAGE + ".").split("."))
    return next((p for p in (place.with_suffix(".py"), place / "__init__.py") if p.is_file()), None)
