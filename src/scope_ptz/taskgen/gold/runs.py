"""Gold runs on disk: reference runs of real tasks, each with one known fault, and what the rules make of them.

The file is gzipped JSONL: a header with the published result, then a run a line. What perception looked at is not stored: it
follows from the calls. Tasks are named, not repeated.
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

from scope_ptz.agent.records import Place
from scope_ptz.bench.program_runner import with_observations
from scope_ptz.bench.scoring.episode import CameraPosition, Episode, EpisodeCall, FrameGeometry, SavedPicture
from scope_ptz.bench.scoring.error_modes import ErrorMode, error_mode
from scope_ptz.bench.scoring.misperceptions import wrong_counts, wrong_reads
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import InputError
from scope_ptz.taskgen.gold.mutations import Gold, Setting, mutate

EYES = FrameGeometry(1280, 720)
PER_MODE = 30
"""Runs of each mode that are wanted: 240 in all."""

OTHER = ("accepted", "not scored")
"""What may become of a faulty run beside the eight modes: it is judged correct, or not judged at all."""


@dataclass(frozen=True)
class Matrix:
    """``cells``: how many runs with a fault of one mode (first) were taken for which (second: a mode, or one of ``OTHER``)."""

    cells: Counter[tuple[str, str]]
    astray: tuple[tuple[str, str, str, str], ...] = ()
    """Of each run off the diagonal the task, the fault, its mode, and what it was taken for."""

    @property
    def total(self) -> int:
        return self.cells.total()

    @property
    def named(self) -> int:
        """Runs whose mode was named as it is."""
        return sum(number for (put_in, told), number in self.cells.items() if put_in == told)

    @property
    def accepted(self) -> int:
        """Faulty runs that were judged correct."""
        return sum(number for (_, told), number in self.cells.items() if told == OTHER[0])

    @property
    def false_accept_rate(self) -> float:
        return self.accepted / self.total if self.total else 0.0

    def worse_than(self, published: Mapping[str, int]) -> bool:
        """Whether fewer runs are named right, or more are let through, than a header says."""
        return self.named < published["named"] or self.accepted > published["accepted"]

    def as_dict(self) -> dict[str, Any]:
        modes = [mode.value for mode in ErrorMode]
        return {
            "runs": self.total,
            "named": self.named,
            "accepted": self.accepted,
            "false_accept_rate": self.false_accept_rate,
            "matrix": {row: {told: n for told in (*modes, *OTHER) if (n := self.cells[row, told])} for row in modes},
            "astray": [dict(zip(("task", "fault", "mode", "told"), one, strict=True)) for one in self.astray],
        }


def gold_runs(
    runs: Sequence[tuple[Task, Episode]], settings: Mapping[str, Setting], seed: int, per_mode: int = PER_MODE
) -> list[Gold]:
    """Faults of every mode put into runs that pass, categories in turn. ``settings``: by world.

    A run in which perception erred, or could not tell, has a fault already and is left aside.
    """
    runs = [(task, run) for task, run in runs if not wrong_counts(task, run, None) and not wrong_reads(task, run)]
    found = list[Gold]()
    for mode in ErrorMode:
        rng = random.Random(f"{seed}:{mode}")
        by_category: dict[str, list[tuple[Task, Episode]]] = {}
        for task, episode in runs:
            by_category.setdefault(task.category, []).append((task, episode))
        for rows in by_category.values():
            rng.shuffle(rows)
        made = list[Gold]()
        while len(made) < per_mode and any(by_category.values()):
            for rows in by_category.values():
                while rows and len(made) < per_mode:
                    task, episode = rows.pop()
                    one = mutate(task, episode, mode, settings[task.world], random.Random(f"{seed}:{mode}:{task.id}"))
                    if one is not None:
                        made.append(one)
                        break
        found += made
    return found


def matrix(gold: Iterable[Gold]) -> Matrix:
    """What the checks and the rules make of gold runs."""
    cells, astray = Counter[tuple[str, str]](), list[tuple[str, str, str, str]]()
    for one in gold:
        told = _told(one)
        cells[one.mode.value, told] += 1
        if told != one.mode.value:
            astray.append((one.task.id, one.fault, one.mode.value, told))
    return Matrix(cells, tuple(astray))


def _told(one: Gold) -> str:
    mode = error_mode(one.task, one.episode)
    if mode is not None:
        return mode.value
    return OTHER[0] if score_episode(one.task, one.episode).headline == "correct" else OTHER[1]


def write_gold(gold: Sequence[Gold], path: Path) -> None:
    """Write runs under a header that says what the rules make of them now. The same runs give the same bytes."""
    result = matrix(gold)
    header = {"gold": 1, "runs": result.total, "named": result.named, "accepted": result.accepted}
    rows = [header, *({"task": g.task.id, "mode": g.mode.value, "fault": g.fault, "run": _run(g.episode)} for g in gold)]
    text = "".join(json.dumps(row, ensure_ascii=False, separators=(",", ":")) + "\n" for row in rows)
    path.write_bytes(gzip.compress(text.encode(), mtime=0))


def read_gold(path: Path, tasks: Iterable[Task]) -> tuple[dict[str, int], list[Gold]]:
    """The header and the runs. Raises ``InputError`` when the file is damaged or names tasks that are not among ``tasks``."""
    by_id = {task.id: task for task in tasks}
    try:
        header, *rows = [json.loads(line) for line in gzip.decompress(path.read_bytes()).decode().splitlines()]
        published = {name: int(header[name]) for name in ("runs", "named", "accepted")}
        gold = [Gold(ErrorMode(row["mode"]), by_id[row["task"]], _episode(row["run"]), row["fault"]) for row in rows]
    except KeyError as error:
        raise InputError(
            f"{path} does not go with these tasks: {error} is missing. Make it again with 'scope bench gold make'."
        ) from error
    except (OSError, EOFError, ValueError, TypeError) as error:
        raise InputError(f"{path} holds no gold runs: {error}.") from error
    if len(gold) != published["runs"]:
        raise InputError(f"{path} should hold {published['runs']} gold runs and holds {len(gold)}. Make it again.")
    return published, gold


def _run(episode: Episode) -> dict[str, Any]:
    return {
        "instruction": episode.instruction,
        "start": _stand(episode.start),
        "calls": [
            {
                "name": call.name,
                "arguments": dict(call.arguments),
                "after": _stand(call.after),
                **{k: v for k in ("result", "error", "fault") if (v := getattr(call, k)) is not None},
                "time_s": round(call.time_s, 4),
            }
            for call in episode.calls
        ],
        "final": _stand(episode.final),
        "text": episode.answer,
        "outcome": episode.outcome,
        "pictures": [picture.file for picture in episode.pictures],
    }


def _stand(at: CameraPosition) -> list[Any]:
    return [at.viewpoint, round(at.pose.pan_deg, 6), round(at.pose.tilt_deg, 6), round(at.pose.zoom, 6)]


def _episode(row: Mapping[str, Any]) -> Episode:
    def stand(values: Sequence[Any]) -> CameraPosition:
        viewpoint, *pose = values
        return CameraPosition(viewpoint, Place(pan_deg=pose[0], tilt_deg=pose[1], zoom=pose[2]).pose())

    at = start = stand(row["start"])
    calls = list[EpisodeCall]()
    for given in row["calls"]:
        further = {name: given.get(name) for name in ("result", "error", "fault")}
        calls.append(
            with_observations(
                EpisodeCall(
                    given["name"], given["arguments"], at, after := stand(given["after"]), time_s=given["time_s"], **further
                ),
                EYES,
            )
        )
        at = after
    pictures = tuple(SavedPicture(name) for name in row["pictures"])
    return Episode(row["instruction"], start, tuple(calls), stand(row["final"]), row["text"], row["outcome"], pictures)
