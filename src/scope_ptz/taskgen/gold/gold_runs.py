"""Create sets of gold runs, score them with the rules for error modes, and read and write them.

The file is gzipped JSONL: a header with the published result, then one run per line. Each run contains its task id. Observations
are not stored, because they can be computed from the calls.
"""

from __future__ import annotations

import gzip
import json
import random
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scope_ptz.agent.records import RecordedPose
from scope_ptz.bench.program_runner import add_observations
from scope_ptz.bench.scoring.episode import CameraPosition, Episode, EpisodeCall, SavedPicture
from scope_ptz.bench.scoring.error_modes import ErrorMode, error_mode
from scope_ptz.bench.scoring.misperceptions import has_wrong_count, has_wrong_reply
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import InputError
from scope_ptz.taskgen.facts.robust import TASK_CAMERA
from scope_ptz.taskgen.gold.mutations import FaultContext, GoldRun, mutate

RUNS_PER_MODE = 30  # number of gold runs per error mode: 240 runs for the eight modes

WITHOUT_MODE = ("accepted", "not scored")
"""Results for a faulty run to which the rules assign no error mode: the run is judged correct, or is not scored."""


@dataclass(frozen=True)
class ConfusionMatrix:
    """Gold runs, counted by the error mode of their fault and the error mode that the rules assign.

    Attributes:
        cells: Number of runs by fault mode and assigned mode, which may be one of ``WITHOUT_MODE``.
        off_diagonal: Task, fault, fault mode and assigned mode for every run whose two modes differ.
    """

    cells: Counter[tuple[str, str]]
    off_diagonal: tuple[tuple[str, str, str, str], ...] = ()

    @property
    def total(self) -> int:
        """Number of runs."""
        return self.cells.total()

    @property
    def correct_modes(self) -> int:
        """Number of runs to which the rules assign the correct mode."""
        return sum(number for (mode, assigned), number in self.cells.items() if mode == assigned)

    @property
    def accepted(self) -> int:
        """Number of runs that were judged correct despite their fault."""
        return sum(number for (_, assigned), number in self.cells.items() if assigned == WITHOUT_MODE[0])

    @property
    def false_accept_rate(self) -> float:
        """Fraction of runs that were judged correct despite their fault."""
        return self.accepted / self.total if self.total else 0.0

    def is_worse_than(self, published: Mapping[str, int]) -> bool:
        """Return whether the rules assign fewer correct modes, or accept more runs, than a published file's header states."""
        return self.correct_modes < published["named"] or self.accepted > published["accepted"]

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON data."""
        modes = [mode.value for mode in ErrorMode]
        return {
            "runs": self.total,
            "named": self.correct_modes,
            "accepted": self.accepted,
            "false_accept_rate": self.false_accept_rate,
            "matrix": {row: {column: n for column in (*modes, *WITHOUT_MODE) if (n := self.cells[row, column])} for row in modes},
            "astray": [dict(zip(("task", "fault", "mode", "told"), one, strict=True)) for one in self.off_diagonal],
        }


def create_gold_runs(
    runs: Sequence[tuple[Task, Episode]], fault_contexts: Mapping[str, FaultContext], seed: int, per_mode: int = RUNS_PER_MODE
) -> list[GoldRun]:
    """Insert faults of every error mode into passing runs.

    Runs in which perception was wrong or could not answer are not used, because they already have a fault.

    Args:
        runs: Tasks with passing runs.
        fault_contexts: Fault contexts by the name of the scene or variation.
        seed: Seed for every random choice.
        per_mode: Number of runs per error mode, taken from the categories in turn.
    """
    runs = [(task, run) for task, run in runs if not has_wrong_count(task, run, None) and not has_wrong_reply(task, run)]
    gold = list[GoldRun]()
    for mode in ErrorMode:
        rng = random.Random(f"{seed}:{mode}")
        by_category: dict[str, list[tuple[Task, Episode]]] = {}
        for task, episode in runs:
            by_category.setdefault(task.category, []).append((task, episode))
        for rows in by_category.values():
            rng.shuffle(rows)
        mode_runs = list[GoldRun]()
        while len(mode_runs) < per_mode and any(by_category.values()):
            for rows in by_category.values():
                while rows and len(mode_runs) < per_mode:
                    task, episode = rows.pop()
                    faulty = mutate(task, episode, mode, fault_contexts[task.world], random.Random(f"{seed}:{mode}:{task.id}"))
                    if faulty is not None:
                        mode_runs.append(faulty)
                        break
        gold += mode_runs
    return gold


def confusion_matrix(gold: Iterable[GoldRun]) -> ConfusionMatrix:
    """Score gold runs with the checks and the rules for error modes, and count the results."""
    cells, off_diagonal = Counter[tuple[str, str]](), list[tuple[str, str, str, str]]()
    for run in gold:
        assigned = _assigned_mode(run)
        cells[run.mode.value, assigned] += 1
        if assigned != run.mode.value:
            off_diagonal.append((run.task.id, run.fault, run.mode.value, assigned))
    return ConfusionMatrix(cells, tuple(off_diagonal))


def _assigned_mode(run: GoldRun) -> str:
    mode = error_mode(run.task, run.episode)
    if mode is not None:
        return mode.value
    return WITHOUT_MODE[0] if score_episode(run.task, run.episode).headline == "correct" else WITHOUT_MODE[1]


def write_gold(gold: Sequence[GoldRun], path: Path) -> None:
    """Write runs to a file, with a header that contains their current result. The same runs always give an identical file."""
    result = confusion_matrix(gold)
    header = {"gold": 1, "runs": result.total, "named": result.correct_modes, "accepted": result.accepted}
    rows = [header, *({"task": g.task.id, "mode": g.mode.value, "fault": g.fault, "run": _episode_data(g.episode)} for g in gold)]
    text = "".join(json.dumps(row, ensure_ascii=False, separators=(",", ":")) + "\n" for row in rows)
    path.write_bytes(gzip.compress(text.encode(), mtime=0))


def read_gold(path: Path, tasks: Iterable[Task]) -> tuple[dict[str, int], list[GoldRun]]:
    """Read a gold run file.

    Args:
        path: The file.
        tasks: The tasks to which the runs belong.

    Returns:
        The numbers in the header, and the runs.

    Raises:
        InputError: The file is damaged, or its runs belong to other tasks.
    """
    by_id = {task.id: task for task in tasks}
    try:
        header, *rows = [json.loads(line) for line in gzip.decompress(path.read_bytes()).decode().splitlines()]
        published = {name: int(header[name]) for name in ("runs", "named", "accepted")}
        gold = [GoldRun(ErrorMode(row["mode"]), by_id[row["task"]], _parse_episode(row["run"]), row["fault"]) for row in rows]
    except KeyError as error:
        raise InputError(
            f"{path} does not belong to these tasks: {error} is missing. Create it again with `scope bench gold make`."
        ) from error
    except (OSError, EOFError, ValueError, TypeError) as error:
        raise InputError(f"{path} is not a gold run file: {error}.") from error
    if len(gold) != published["runs"]:
        raise InputError(
            f"{path} should contain {published['runs']} gold runs, but contains {len(gold)}. "
            "Create it again with `scope bench gold make`."
        )
    return published, gold


def _episode_data(episode: Episode) -> dict[str, Any]:
    return {
        "instruction": episode.instruction,
        "start": _position_data(episode.start),
        "calls": [
            {
                "name": call.name,
                "arguments": dict(call.arguments),
                "after": _position_data(call.after),
                **{k: v for k in ("result", "error", "fault") if (v := getattr(call, k)) is not None},
                "time_s": round(call.time_s, 4),
            }
            for call in episode.calls
        ],
        "final": _position_data(episode.final),
        "text": episode.answer,
        "outcome": episode.outcome,
        "pictures": [picture.file for picture in episode.pictures],
    }


def _position_data(at: CameraPosition) -> list[Any]:
    return [at.viewpoint, round(at.pose.pan_deg, 6), round(at.pose.tilt_deg, 6), round(at.pose.zoom, 6)]


def _parse_episode(row: Mapping[str, Any]) -> Episode:
    def position(values: Sequence[Any]) -> CameraPosition:
        viewpoint, *pose = values
        return CameraPosition(viewpoint, RecordedPose(pan_deg=pose[0], tilt_deg=pose[1], zoom=pose[2]).pose())

    at = start = position(row["start"])
    calls = list[EpisodeCall]()
    for stored in row["calls"]:
        optional = {name: stored.get(name) for name in ("result", "error", "fault")}
        calls.append(
            add_observations(
                EpisodeCall(
                    stored["name"], stored["arguments"], at, after := position(stored["after"]), time_s=stored["time_s"], **optional
                ),
                TASK_CAMERA,
            )
        )
        at = after
    pictures = tuple(SavedPicture(name) for name in row["pictures"])
    return Episode(row["instruction"], start, tuple(calls), position(row["final"]), row["text"], row["outcome"], pictures)
