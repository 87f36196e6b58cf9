"""The dataset card: a page made from the dataset's own files, so that it cannot say anything else than they do."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.tasks.splits import load_split, read_manifest
from scope_ptz.bench.tasks.task import CANARY, Task
from scope_ptz.errors import InputError
from scope_ptz.taskgen.dataset import distributions as d
from scope_ptz.taskgen.gold.gold_runs import OTHER, matrix, read_gold
from scope_ptz.taskgen.picture_audit import Audit, Held, read_audit, task_digest

GOLD, PROOF, AUDIT = "gold.jsonl.gz", "proof.json", "audit.json"
_ABOUT = {
    "core": "the tasks that scores are about",
    "lite": "a tenth of the core, stratified by category, scene and difficulty",
    "paraphrase": "further wordings of core tasks",
    "reaction": "requests that want a question back or a refusal",
    "unseen": "tasks of varied worlds, by the same rules",
}


@dataclass(frozen=True)
class Dataset:
    """A dataset folder, read."""

    splits: Mapping[str, tuple[Task, ...]]
    manifest: Mapping[str, Any]
    proof: Mapping[str, Any]
    gold: Path
    audit: Audit | None

    @classmethod
    def read(cls, folder: Path) -> Dataset:
        """Raises ``InputError`` when anything is missing, or changed since it was built."""
        manifest = read_manifest(folder)
        try:
            proof = json.loads((folder / PROOF).read_text("utf-8"))
        except (OSError, ValueError) as error:
            raise InputError(f"{folder / PROOF} cannot be read ({error}). Build the dataset again.") from error
        splits = {name: load_split(name, folder) for name in _ABOUT}
        audit = read_audit(folder / AUDIT) if (folder / AUDIT).is_file() else None
        return cls(splits, manifest, proof, folder / GOLD, audit)


def card(data: Dataset) -> str:
    """The card in Markdown."""
    parts = [
        "# Dataset card: the SCOPE tasks",
        "<!-- Written by `scope bench card`. Change the data or the program, not this page. -->",
        *_what(data),
        *_contents(data),
        *_answers(data),
        *_proof(data),
        *_gold(data),
        *_audit(data),
        *_files(data),
    ]
    return "\n\n".join(parts) + "\n"


def _what(data: Dataset) -> Iterator[str]:
    core = data.splits["core"]
    scenes = ", ".join(f"`{name}` (version {facts['version']})" for name, facts in data.manifest["scenes"].items())
    yield (
        f"{len(core)} instructions for a pan-tilt-zoom camera in simulated scenes, each with an answer or a behaviour that is "
        f"checked by executing rules. Scenes: {scenes}."
    )
    yield "## What it is for"
    yield (
        "Measuring how well an agent, a planner and a perception model together, carries out spoken requests to one camera: where "
        "it looks, what it counts, reads, finds and compares, and whether it does what was asked and nothing else. Comparing "
        "pairs of models under equal conditions. Finding out why runs fail.\n\n"
        "It is not for training: a model that has seen the tasks says nothing about unseen ones. It is not evidence that an agent "
        "is fit to watch people or to guard anything."
    )
    yield "## How it was made"
    yield (
        "The instructions, the scenes and the programs are the project's own. No language model takes part, no expected value is "
        "typed by hand: a program reads the ground truth of views of the scenes, drafts what can be asked of them, and keeps what "
        "is so beyond doubt, at poses 0.5 degrees and 3% of zoom around and with visibility thresholds 30% lower and higher. "
        "[The benchmark](benchmark.md) has the rules. The same scenes in the same order, and the same seed, give the same bytes:"
    )
    made = data.manifest["made_with"]
    unseen = " ".join(map(str, made["unseen"]))
    scenes = " ".join(f"--scene {name}" for name in data.manifest["scenes"])
    yield f"```sh\nscope bench build --all {scenes} --seed {made['seed']} --seeds {unseen} \\\n  --out DIR --card dataset.md\n```"
    yield (
        "The unseen tasks are set in varied worlds: the same baked scenes at other scene times, with moving things that come at "
        "other times, stand still somewhere or are gone, and with other presets under other names. Picture and truth come from "
        "the same composition, so that both change alike."
    )
    yield "## Limits"
    yield (
        "- Everything is simulated: clean pictures by a path tracer, no lens dirt, no compression, one light and weather a scene.\n"
        "- What cannot be told beyond doubt is left out. That removes hard cases that a real site has: crowds, half-hidden things, "
        "things with disputed names or colours.\n"
        "- English only, from sentence patterns that one project wrote, however varied.\n"
        "- Scenes are British and European in their signs, vehicles and clothes.\n"
        "- The unseen worlds share their buildings and parked things with the published ones: they test wording, poses, times and "
        "moving things, not new places.\n"
        "- What is baked, lettering most of all, is the same in every split: whoever has seen the answers of one split "
        "(unseen too) knows much of the others by scene and name. Scores of models that were trained on any of them say nothing.\n"
        "- Ground-truth perception is written by the same people as the tasks, though the code that reads language is not shared."
    )
    yield "## Licence, people, canary"
    yield (
        "Apache-2.0, like the program and the scenes. No real person, place or company is shown or meant.\n\n"
        f"Every task holds the string `{CANARY}`. Leave out of training data whatever holds it."
    )


def _contents(data: Dataset) -> Iterator[str]:
    core = data.splits["core"]
    yield "## What is in it"
    yield d.markdown_table(("split", "tasks", "what it is"), [(n, len(rows), _ABOUT[n]) for n, rows in data.splits.items()])
    yield "Core tasks by category and scene:"
    yield d.markdown_table(*d.crossed(core, lambda t: t.category, lambda t: t.scene))
    yield "By category and difficulty (a rule: how many calls, how many things to tell apart, a sweep):"
    yield d.markdown_table(*d.crossed(core, lambda t: t.category, lambda t: t.difficulty))
    yield "By category and scope:"
    yield d.markdown_table(*d.crossed(core, lambda t: t.category, lambda t: t.scope))
    yield "By the viewpoint that the answer rests on:"
    yield d.chart(d.spread(core, lambda t: [d.viewpoint(t)]))
    yield "By what a task takes before it can be answered (several may apply):"
    yield d.chart(d.spread(core, lambda t: t.needs or ("nothing",)))


def _answers(data: Dataset) -> Iterator[str]:
    core = data.splits["core"]
    yield "## Answers"
    rows = [
        (name, size, different, ", ".join(f"{value} ({n})" for value, n in most)) for name, size, different, most in d.answers(core)
    ]
    yield d.markdown_table(("category", "tasks", "different answers", "most frequent"), rows)
    yield "How often each number is right (“there is none” as 0):"
    yield d.chart(d.numbers(core))
    stays = d.from_start(core)
    yield (
        f"{d.pairs(core)} tasks have the answer “there is none”, each beside one of like wording whose answer is a presence. "
        f"{stays} of {len(core)} ({stays / len(core):.1%}) can be answered from the start view alone."
    )


def _proof(data: Dataset) -> Iterator[str]:
    yield "## Proof"
    yield "`scope bench validate` runs these on every task through the real tools; a cheat must pass none."
    names = list(dict.fromkeys(name for proof in data.proof.values() for name in (*proof["right_ways"], *proof["cheats"])))
    rows: list[Sequence[str | int]] = []
    for name in names:
        kind = "right way" if any(name in proof["right_ways"] for proof in data.proof.values()) else "cheat"
        shares = []
        for proof in data.proof.values():
            row = proof["right_ways"].get(name) or proof["cheats"].get(name)
            shares.append(f"{row['passed']} of {row['of']}" if row else "")
        rows.append((name, kind, *shares))
    yield d.markdown_table(("attempt", "", *(f"{name}: passes" for name in data.proof)), rows)


def _gold(data: Dataset) -> Iterator[str]:
    _, runs = read_gold(data.gold, data.splits["core"])
    result = matrix(runs)
    columns = [*(mode.value for mode in ErrorMode), *OTHER]
    yield "## Error modes"
    yield (
        f"{result.total} reference runs with one known fault each (`scope bench gold check`): {result.named} are named as what "
        f"they are, {result.accepted} are judged correct (false-accept rate {result.false_accept_rate:.1%}). The faults were put "
        "in by rules, so this proves that the rules for error modes are consistent, not that people would agree with them on "
        "every run."
    )
    rows = [(m.value, *(result.cells[m.value, told] or "·" for told in columns)) for m in ErrorMode]
    yield d.markdown_table(("put in \\ taken for", *columns), rows)


def _audit(data: Dataset) -> Iterator[str]:
    yield "## Audit by readers of pictures"
    if data.audit is None:
        yield "None has been made of this version."
        return
    audit, by_id = data.audit, {task.id: task for task in data.splits["core"]}
    right, of = audit.share()
    yield (
        f"Readers saw the frames that an answer rests on and the words of the task, nothing else; tasks were drawn by category, "
        f"scene and difficulty (`scope bench audit make --n {audit.draw.number} --seed {audit.draw.seed}`). {right} of {of} "
        f"answers agree with the expected value ({right / of:.1%}); {len(audit.rows) - of} of the tasks drawn got no answer."
        if of
        else "Nothing was answered."
    )
    categories = sorted({row.category for row in audit.rows})
    shares = [(name, *audit.share(row for row in audit.rows if row.category == name)) for name in categories]
    yield d.markdown_table(("category", "agree", "of"), shares)
    off = [row for row in audit.rows if row.outcome != "agrees"]
    if off:
        yield "Every answer that does not agree; a task that is gone or reads otherwise since is marked as mended:"
        yield d.markdown_table(
            ("task", "asked", "expected", "reader said", "", "what it was"),
            [(row.task, row.instruction, row.expected, row.answer, row.outcome, _finding(row, by_id)) for row in off],
        )


def _finding(row: Held, by_id: Mapping[str, Task]) -> str:
    task = by_id.get(row.task)
    mended = task is None or task_digest(task) != row.digest
    return " ".join(part for part in (row.finding, "(mended)" if mended else "") if part) or "open"


def _files(data: Dataset) -> Iterator[str]:
    yield "## Files (SHA-256)"
    yield d.markdown_table(("file", "checksum"), [(name, f"`{digest}`") for name, digest in data.manifest["files"].items()])
