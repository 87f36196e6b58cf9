"""The splits of the dataset and their files.

core        the 536 tasks
lite        a tenth of the core tasks, stratified by category, scene and difficulty
paraphrase  other wordings of core tasks
reaction    requests that call for a question or a refusal
unseen      tasks of varied worlds, made after the core by the same rules
all         core, paraphrase and reaction together
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from scope_ptz.bench.tasks.files import dump_tasks, load_tasks
from scope_ptz.bench.tasks.stratified import stratified_sample
from scope_ptz.bench.tasks.task import CANARY, Stratum, Task
from scope_ptz.errors import InputError, OutputError, UnknownNameError
from scope_ptz.simulator.pack import Scene

SPLITS = ("core", "lite", "paraphrase", "reaction", "unseen", "all")
FILES = {"core": "tasks.jsonl", "paraphrase": "paraphrase.jsonl", "reaction": "reaction.jsonl", "unseen": "unseen.jsonl"}
LITE, MANIFEST = "lite.txt", "manifest.json"
LITE_SHARE = 0.1


def published_folder() -> Path:
    """Return the folder of the dataset that comes with the package."""
    return Path(str(files("scope_ptz"))) / "data" / "bench"


def load_split(name: str | Path, folder: Path | None = None) -> tuple[Task, ...]:
    """Load the tasks of a split or of a task file.

    Args:
        name: Name of a split, or path of a JSONL or YAML file.
        folder: Folder of another dataset, as ``scope bench build --all`` writes it. The default is the published dataset.

    Raises:
        UnknownNameError: The name is neither a split nor a file.
        InputError: A file is missing or holds something other than tasks.
    """
    folder = folder or published_folder()
    if str(name) not in SPLITS:
        path = Path(name)
        if not path.suffix and not path.is_file():
            raise UnknownNameError("split or task file", str(name), SPLITS)
        return load_tasks(path)
    if not (folder / FILES["core"]).is_file():
        raise InputError(f"There are no tasks in {folder}. Make some with 'scope bench build' and name their file.")
    if name == "all":
        return tuple(task for part in ("core", "paraphrase", "reaction") for task in load_tasks(folder / FILES[part]))
    if name == "lite":
        return _named(load_tasks(folder / FILES["core"]), folder / LITE)
    return load_tasks(folder / FILES[str(name)])


def _named(tasks: Iterable[Task], path: Path) -> tuple[Task, ...]:
    """Return the tasks whose ids a file lists, one per line."""
    try:
        ids = path.read_text("utf-8").split()
    except OSError as error:
        raise InputError(f"The list {path} cannot be read: {error.strerror}. Build the dataset again.") from error
    by_id = {task.id: task for task in tasks}
    if unknown := [name for name in ids if name not in by_id]:
        raise InputError(f"{path} names {unknown[0]}, which is no task of the core. Build the dataset again.")
    return tuple(by_id[name] for name in ids)


def lite(tasks: Sequence[Task], seed: int) -> tuple[Task, ...]:
    """Return a stratified tenth of the core tasks."""
    core = of_stratum(tasks, "core")
    return stratified_sample(core, round(len(core) * LITE_SHARE), seed)


def of_stratum(tasks: Iterable[Task], stratum: Stratum) -> tuple[Task, ...]:
    """Return the tasks of one stratum."""
    return tuple(task for task in tasks if task.stratum == stratum)


def write_splits(tasks: Sequence[Task], unseen: Sequence[Task], folder: Path, *, seed: int) -> list[Path]:
    """Write a dataset with one file per split. The same tasks and seed give the same bytes.

    Returns:
        The files that were written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for split, rows in (
            ("core", of_stratum(tasks, "core")),
            ("paraphrase", of_stratum(tasks, "paraphrase")),
            ("reaction", of_stratum(tasks, "reaction")),
            ("unseen", unseen),
        ):
            dump_tasks(rows, folder / FILES[split])
        (folder / LITE).write_text("".join(f"{task.id}\n" for task in lite(tasks, seed)), "utf-8")
    except OSError as error:
        raise OutputError(f"The dataset cannot be written to {folder}: {error.strerror}. Choose another with --out.") from error
    return [folder / name for name in (*FILES.values(), LITE)]


def write_manifest(folder: Path, written: Iterable[Path], scenes: Iterable[Scene], **made_with: Any) -> Path:
    """Write the manifest of a dataset: how it was made, the versions of its scenes, and the checksums of its files."""
    content = {
        "canary": CANARY,
        "made_with": made_with,
        "scenes": {scene.name: {"version": scene.file.version, "sha256": _digest(scene.folder / "scene.json")} for scene in scenes},
        "files": {path.name: _digest(path) for path in sorted(written)},
    }
    path = folder / MANIFEST
    path.write_text(json.dumps(content, indent=1) + "\n", "utf-8")
    return path


def read_manifest(folder: Path) -> dict[str, Any]:
    """Read the manifest of a dataset and verify its files.

    Raises:
        InputError: A file of the dataset is missing or has changed.
    """
    try:
        content: dict[str, Any] = json.loads((folder / MANIFEST).read_text("utf-8"))
        changed = [name for name, digest in content["files"].items() if _digest(folder / name) != digest]
    except (OSError, ValueError, KeyError) as error:
        raise InputError(f"{folder} holds no whole dataset ({error}). Make one with 'scope bench build --all'.") from error
    if changed:
        raise InputError(f"{folder / changed[0]} is not as it was built. Build the dataset again.")
    return content


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
