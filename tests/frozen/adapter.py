"""Interface of these tests to the program: the only module that uses its commands, options, modules and file locations.

When a command, an option or a module is renamed, change only this module, not the stored data or the comparisons. It uses the
command line where possible, and imports modules only for results that no command prints.
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
"""Registry name, in Inspect, of the provider for models whose names begin with ``scope_ptz/``."""
PROMPTS = {
    "planner": "planner/chat/prompts",
    "judge": "bench/judging/prompts",
}
"""Folders of prompt files inside the package."""
DATASET = "data/bench"
SCENES = "data/scenes"
SCHEMAS = ("data/tasks.schema.json", "data/submission.schema.json")
DATASET_FILES = ("tasks", "unseen", "paraphrase", "reaction")
LANGUAGE_FILES = {"english/grammar/questions": "perception", "english/grammar": "english"}
"""Folders with the grammars and word lists for instructions and for perception questions, with their names in the stored data."""


@dataclass(frozen=True)
class CommandResult:
    """Exit code and output of a command."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        """The standard output, parsed as one JSON document."""
        return json.loads(self.out)


def run(*arguments: str, stdin: str = "") -> CommandResult:
    """Run ``scope`` in this process with a clean environment."""
    from scope_ptz.cli import main

    inherited = {name: value for name, value in os.environ.items() if not name.startswith("SCOPE_")}
    out, err, code = io.StringIO(), io.StringIO(), 0
    with (
        mock.patch.dict(os.environ, {**inherited, "COLUMNS": "200"}, clear=True),
        mock.patch.object(sys, "argv", ["scope", *arguments]),
        mock.patch.object(sys, "stdin", io.StringIO(stdin)),
        redirect_stdout(out),
        redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as ended:
            code = ended.code if isinstance(ended.code, int) else 0
    return CommandResult(code, out.getvalue(), err.getvalue())


# Runs


def replay(folder: Path) -> tuple[int, dict[str, Any]]:
    """Replay a run and return the exit code and the result, without fields that contain sentences for users."""
    command = run("replay", str(folder), "--json")
    result = command.json
    if "error" in result:
        return command.code, {"error": True}
    recorded = result["recorded"]
    if recorded is not None:
        recorded = {key: value for key, value in recorded.items() if key != "run_dir"}
    return command.code, {
        "recorded": recorded,
        "repeated": result["repeated"],
        "equal": result["equal"],
        "differs": [bool(difference) for difference in result["differences"]],
        "outcome_differs": bool(result["outcome_difference"]),
    }


def ask(instruction: str, runs: Path, *, planner: Mapping[str, str] | None = None, perception: str = "") -> list[dict[str, Any]]:
    """Execute an instruction and return the records of its trace.

    Args:
        planner: URL ("url") and options of a chat model. Without it, the grammar planner is used.
        perception: URL of a vision model. Without it, ground truth is used.
    """
    options = ["--fast", "--json", "--runs-dir", str(runs)]
    if planner:
        options += ["--planner", "chat", "--planner-url", planner["url"]]
        for name, value in planner.items():
            if name != "url":
                options += ["--planner-option", f"{name}={value}"]
    if perception:
        options += ["--perception", "openai_vision", "--perception-url", perception]
    result = run("ask", instruction, *options)
    (trace,) = runs.glob("*/trace.jsonl")
    assert result.json["outcome"], result.err
    return [json.loads(line) for line in trace.read_text("utf-8").splitlines()]


def plan(instructions: Iterable[tuple[str, Sequence[str]]], scratch: Path) -> list[dict[str, Any]]:
    """Return the plan of each instruction, given with its presets. Keys: instruction, understood, calls, clarification."""
    lines = (json.dumps({"instruction": instruction, "presets": list(presets)}) for instruction, presets in instructions)
    scratch.write_text("\n".join(lines) + "\n", "utf-8")
    result = run("plan", "--from", str(scratch), "--json")
    assert result.code == 0, result.err
    return [json.loads(line) for line in result.out.splitlines()]


def tool_schemas() -> Any:
    """Return the schemas of the tools."""
    return run("tools", "--json").json


# Logs


def read_log(log: Path) -> dict[str, Any]:
    """Read a log and return its card, and all trials with headline, error mode, checks and judgements."""
    from scope_ptz.bench.engine.logs import read_evaluation

    content = read_evaluation(log).model_dump(mode="json", by_alias=True)
    del content["log"]
    content.pop("failure", None)  # Version 0.1.0 did not read why an evaluation ended.
    return content


def rescore_checks(log: Path) -> CommandResult:
    """Run the current checks on a log and add their scores."""
    return run("bench", "rescore", str(log), "--checks")


def rescore_judge(log: Path, url: str) -> CommandResult:
    """Run a judge on a log, one run at a time, and add its judgements."""
    return run("bench", "rescore", str(log), "--judge-url", url, "--concurrency", "1")


def report_tables(logs: Sequence[Path], out: Path) -> dict[str, str]:
    """Write a report of logs and return its tables as CSV, by file name."""
    result = run("bench", "report", *map(str, logs), "--out", str(out), "--no-pages")
    assert result.code == 0, result.err
    return {table.name: table.read_text("utf-8") for table in sorted((out / "tables").glob("*.csv"))}


def make_submission(log: Path, out: Path) -> list[dict[str, Any]]:
    """Make a submission from a log without traces, as version 0.1.0 did, and return its lines."""
    result = run("bench", "submission", "make", str(log), "--out", str(out), "--no-traces")
    assert result.code == 0, result.err
    return [json.loads(line) for line in out.read_text("utf-8").splitlines()]


def validate_submission(file: Path) -> tuple[int, dict[str, Any]]:
    """Validate a submission and return the exit code, whether it is valid, the number of faults, and the counts."""
    command = run("bench", "submission", "validate", str(file), "--json")
    result = command.json
    return command.code, {"valid": result["valid"], "faults": len(result["faults"]), "counts": result["counts"]}


# The dataset


def validate_tasks() -> tuple[int, dict[str, Any]]:
    """Validate the published tasks and return the exit code and the report."""
    result = run("bench", "validate", "--json")
    return result.code, {name: value for name, value in result.json.items() if name != "adaptive"}  # since 0.2.0


def check_gold() -> tuple[int, dict[str, Any]]:
    """Check the gold runs and return the exit code and the report."""
    result = run("bench", "gold", "check", "--json")
    return result.code, result.json


# Files


def sha256(path: Path) -> str:
    """Return the SHA-256 digest of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _package() -> Path:
    return Path(str(files(PACKAGE)))


def digests() -> dict[str, dict[str, str]]:
    """Return the SHA-256 digests of files that must not change, by group and by a name that does not depend on their location."""
    package = _package()

    def group(folder: str, pattern: str) -> dict[str, str]:
        root = package / folder
        return {path.relative_to(root).as_posix(): sha256(path) for path in sorted(root.glob(pattern)) if path.is_file()}

    return {
        **{f"prompts/{name}": group(folder, "*.md") for name, folder in PROMPTS.items()},
        "language": {
            f"{label}/{name}": digest
            for folder, label in LANGUAGE_FILES.items()
            for suffix in ("lark", "txt", "rules")
            for name, digest in group(folder, f"*.{suffix}").items()
        },
        "schemas": {Path(name).name: sha256(package / name) for name in SCHEMAS},
        "dataset": group(DATASET, "*"),
        "scenes": {**group(SCENES, "*/scene.json"), **group(SCENES, "*/*/manifest.json")},
    }


def published_tasks() -> list[dict[str, Any]]:
    """Return all tasks of the published dataset, including paraphrases and reaction tasks, in the order of the files."""
    folder = _package() / DATASET
    return [json.loads(line) for name in DATASET_FILES for line in (folder / f"{name}.jsonl").read_text("utf-8").splitlines()]


# Names in logs


def load_registered_names() -> None:
    """Import the module that Inspect loads through the entry point in ``pyproject.toml``."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    import_module(project["entry-points"]["inspect_ai"][PACKAGE])


def resolves(kind: str, name: str) -> bool:
    """Return whether Inspect's registry has this name. ``kind`` is task, solver, scorer, metric or modelapi."""
    from inspect_ai._util.registry import registry_lookup

    load_registered_names()
    return registry_lookup(kind, name) is not None  # type: ignore[arg-type]


# Logs as files, without code of the program


def samples_of(log: Path) -> dict[str, dict[str, Any]]:
    """Return the samples of a log as plain data, by task and epoch."""
    import inspect_ai.log  # adds the compression of logs to zipfile

    assert inspect_ai.log
    found = {}
    with ZipFile(log) as archive:
        for name in sorted(n for n in archive.namelist() if n.startswith("samples/")):
            sample = json.loads(archive.read(name))
            found[f"{sample['id']}#{sample['epoch']}"] = sample
    return found


def header_of(log: Path) -> dict[str, Any]:
    """Return the header of a log as plain data."""
    import inspect_ai.log

    assert inspect_ai.log
    with ZipFile(log) as archive:
        header: dict[str, Any] = json.loads(archive.read("header.json"))
        return header


def scores_of(log: Path) -> dict[str, dict[str, Any]]:
    """Return the value, answer, headline and error mode of every score of every sample."""
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
def copied_log(log: Path, folder: Path) -> Iterator[Path]:
    """Yield a copy of a log in ``folder``, which the test may modify."""
    folder.mkdir(parents=True, exist_ok=True)
    yield Path(shutil.copy2(log, folder / log.name))
