"""The only module of these tests that knows names of the program: its commands, options, modules and places of files.

When a command, an option or a module gets another name, change it here and nowhere else. The stored data and the comparisons stay.
The command line is preferred; modules are imported only where no command shows what is compared.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import os
import shutil
import sys
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from importlib import import_module
from importlib.resources import files
from pathlib import Path
from typing import Any
from unittest import mock
from zipfile import ZipFile

ROOT = Path(__file__).parents[2]
PACKAGE = "scope_ptz"
MODEL_PROVIDER = "scope_ptz/scope_ptz"
"""How Inspect's registry calls the provider of models whose names begin with ``scope_ptz/``."""
PROMPTS = {
    "planner": "planner/chat/prompts",
    "judge": "bench/judging/prompts",
}
"""Folders of prompt files inside the package."""
DATASET = "data/bench"
SCENES = "data/scenes"
SCHEMAS = ("data/tasks.schema.json", "data/submission.schema.json")
DATASET_FILES = ("tasks", "unseen", "paraphrase", "reaction")
LANGUAGE_FILES = ("planner/grammar/lexing", "planner/grammar/parsing", "perception/ground_truth/language")
"""Folders with the grammars and word lists of instructions and of perception's questions."""


@dataclass(frozen=True)
class Done:
    """How a command ended and what it printed."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        """Its output as one JSON document."""
        return json.loads(self.out)


def run(*arguments: str, stdin: str = "") -> Done:
    """Run ``scope`` in this process with a clean environment."""
    from scope_ptz.cli import main

    kept = {name: value for name, value in os.environ.items() if not name.startswith("SCOPE_")}
    out, err, code = io.StringIO(), io.StringIO(), 0
    with (
        mock.patch.dict(os.environ, {**kept, "COLUMNS": "200"}, clear=True),
        mock.patch.object(sys, "argv", ["scope", *arguments]),
        mock.patch.object(sys, "stdin", io.StringIO(stdin)),
        redirect_stdout(out),
        redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as ended:
            code = ended.code if isinstance(ended.code, int) else 0
    return Done(code, out.getvalue(), err.getvalue())


# Runs


def replay(folder: Path) -> tuple[int, dict[str, Any]]:
    """The exit code of a replay, and what it found: fields that are data, without sentences for people."""
    done = run("replay", str(folder), "--json")
    said = done.json
    if "error" in said:
        return done.code, {"error": True}
    recorded = said["recorded"]
    if recorded is not None:
        recorded = {key: value for key, value in recorded.items() if key != "run_dir"}
    return done.code, {
        "recorded": recorded,
        "repeated": said["repeated"],
        "equal": said["equal"],
        "differs": [bool(difference) for difference in said["differences"]],
        "outcome_differs": bool(said["outcome_difference"]),
    }


def ask(instruction: str, runs: Path, *, planner: Mapping[str, str] | None = None, eyes: str = "") -> list[dict[str, Any]]:
    """Carry out an instruction and return the records of its trace.

    ``planner``: the address of a chat model ("url") and its options; the built-in planner without. ``eyes``: the address of a chat
    model that sees; ground truth without.
    """
    options = ["--fast", "--json", "--runs-dir", str(runs)]
    if planner:
        options += ["--planner", "chat", "--planner-url", planner["url"]]
        for name, value in planner.items():
            if name != "url":
                options += ["--planner-option", f"{name}={value}"]
    if eyes:
        options += ["--perception", "openai_vision", "--perception-url", eyes]
    done = run("ask", instruction, *options)
    (trace,) = runs.glob("*/trace.jsonl")
    assert done.json["outcome"], done.err
    return [json.loads(line) for line in trace.read_text("utf-8").splitlines()]


def plan(instructions: Iterable[tuple[str, Sequence[str]]], scratch: Path) -> list[dict[str, Any]]:
    """The plan of each instruction with its presets. Keys: instruction, understood, calls, clarification."""
    lines = (json.dumps({"instruction": words, "presets": list(presets)}) for words, presets in instructions)
    scratch.write_text("\n".join(lines) + "\n", "utf-8")
    done = run("plan", "--from", str(scratch), "--json")
    assert done.code == 0, done.err
    return [json.loads(line) for line in done.out.splitlines()]


def tool_schemas() -> Any:
    """The tools' schemas with their descriptions."""
    return run("tools", "--json").json


# Logs


def read_log(log: Path) -> dict[str, Any]:
    """A log as the program reads it: the card, and every trial with its headline, error mode, checks and judgements."""
    from scope_ptz.bench.engine.logs import read_evaluation

    content = read_evaluation(log).model_dump(mode="json", by_alias=True)
    del content["log"]
    return content


def rescore_checks(log: Path) -> Done:
    """Add the scores of today's checks to a log."""
    return run("bench", "rescore", str(log), "--checks")


def rescore_judge(log: Path, url: str) -> Done:
    """Add the judgements of a judge to a log, one run at a time."""
    return run("bench", "rescore", str(log), "--judge-url", url, "--concurrency", "1")


def report_tables(logs: Sequence[Path], out: Path) -> dict[str, str]:
    """The tables that a report of logs writes, as CSV by name."""
    done = run("bench", "report", *map(str, logs), "--out", str(out), "--no-pages")
    assert done.code == 0, done.err
    return {table.name: table.read_text("utf-8") for table in sorted((out / "tables").glob("*.csv"))}


def make_submission(log: Path, out: Path) -> list[dict[str, Any]]:
    """The lines of the submission that is made of a log."""
    done = run("bench", "submission", "make", str(log), "--out", str(out))
    assert done.code == 0, done.err
    return [json.loads(line) for line in out.read_text("utf-8").splitlines()]


def validate_submission(file: Path) -> tuple[int, dict[str, Any]]:
    """The exit code, and what the check of a submission found: whether it is valid, how many faults, what was counted."""
    done = run("bench", "submission", "validate", str(file), "--json")
    said = done.json
    return done.code, {"valid": said["valid"], "faults": len(said["faults"]), "counts": said["counts"]}


# The dataset


def validate_tasks() -> tuple[int, dict[str, Any]]:
    """The exit code and the report of the proof of the published tasks."""
    done = run("bench", "validate", "--json")
    return done.code, done.json


def check_gold() -> tuple[int, dict[str, Any]]:
    """The exit code and the matrix of the gold runs."""
    done = run("bench", "gold", "check", "--json")
    return done.code, done.json


# Files


def sha256(path: Path) -> str:
    """Digest of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _package() -> Path:
    return Path(str(files(PACKAGE)))


def digests() -> dict[str, dict[str, str]]:
    """SHA-256 of files whose bytes are part of the program's promises, by group and by a name that no move of files changes."""
    package = _package()

    def group(folder: str, pattern: str) -> dict[str, str]:
        root = package / folder
        return {path.relative_to(root).as_posix(): sha256(path) for path in sorted(root.glob(pattern)) if path.is_file()}

    return {
        **{f"prompts/{name}": group(folder, "*.md") for name, folder in PROMPTS.items()},
        "language": {
            f"{Path(folder).parts[0]}/{name}": digest
            for folder in LANGUAGE_FILES
            for suffix in ("lark", "txt", "rules")
            for name, digest in group(folder, f"*.{suffix}").items()
        },
        "schemas": {Path(name).name: sha256(package / name) for name in SCHEMAS},
        "dataset": group(DATASET, "*"),
        "scenes": {**group(SCENES, "*/scene.json"), **group(SCENES, "*/*/manifest.json")},
    }


def published_tasks() -> list[dict[str, Any]]:
    """Every task of the published dataset, wordings and reactions included, in the order of the files."""
    folder = _package() / DATASET
    return [json.loads(line) for name in DATASET_FILES for line in (folder / f"{name}.jsonl").read_text("utf-8").splitlines()]


# Names in logs


def load_registered_names() -> None:
    """Import what Inspect imports of this package through the entry point that ``pyproject.toml`` names."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    import_module(project["entry-points"]["inspect_ai"][PACKAGE])


def resolves(kind: str, name: str) -> bool:
    """Whether Inspect finds what is registered under a name of a log. ``kind``: task, solver, scorer, metric or modelapi."""
    from inspect_ai._util.registry import registry_lookup

    load_registered_names()
    return registry_lookup(kind, name) is not None  # type: ignore[arg-type]


# Logs as files; nothing of the program


def samples_of(log: Path) -> dict[str, dict[str, Any]]:
    """The samples of a log as plain data, by task and epoch."""
    import inspect_ai.log  # teaches zipfile the compression of logs

    assert inspect_ai.log
    found = {}
    with ZipFile(log) as archive:
        for name in sorted(n for n in archive.namelist() if n.startswith("samples/")):
            sample = json.loads(archive.read(name))
            found[f"{sample['id']}#{sample['epoch']}"] = sample
    return found


def header_of(log: Path) -> dict[str, Any]:
    """The header of a log as plain data."""
    import inspect_ai.log

    assert inspect_ai.log
    with ZipFile(log) as archive:
        header: dict[str, Any] = json.loads(archive.read("header.json"))
        return header


def scores_of(log: Path) -> dict[str, dict[str, Any]]:
    """Value, answer, headline and error mode of every score of every sample."""
    return {
        name: {
            score: {
                "value": None if _is_nan(found["value"]) else found["value"],
                "answer": found.get("answer"),
                "headline": (found.get("metadata") or {}).get("headline"),
                "error_mode": (found.get("metadata") or {}).get("error_mode"),
            }
            for score, found in sorted((sample.get("scores") or {}).items())
        }
        for name, sample in samples_of(log).items()
    }


def _is_nan(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)


@contextmanager
def copied(log: Path, folder: Path) -> Iterator[Path]:
    """A copy of a log that may be written to."""
    folder.mkdir(parents=True, exist_ok=True)
    yield Path(shutil.copy2(log, folder / log.name))
