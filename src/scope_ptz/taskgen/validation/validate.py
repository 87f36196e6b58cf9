"""Proof of a dataset: reference programs pass, other right ways pass, cheats do not. Every run goes through the real tools."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from scope_ptz.bench.answers import agrees, parse_answer
from scope_ptz.bench.program_runner import MakeToolContext, ProgramRunner
from scope_ptz.bench.scoring.episode import Episode, FrameGeometry
from scope_ptz.bench.scoring.misperceptions import wrong_reads
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.expected import ActionOnly, NoneThere, Number
from scope_ptz.bench.tasks.task import Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import view_truth
from scope_ptz.taskgen.facts.phrasing import right_answers
from scope_ptz.taskgen.validation.adversarial import Attempt, cheats, common_answers, guesses, honest, right_texts
from scope_ptz.taskgen.validation.consistency import Look, inconsistencies

MOST_GUESSED = 0.03
"""No answer that is given after looking, whatever was seen, is right for more of the core tasks; pairs count when both pass."""

ENOUGH = 300
"""Of fewer core tasks such a share says nothing."""

EYES = FrameGeometry(1280, 720)
Say = Callable[[int, int], None]


@dataclass(frozen=True)
class Fault:
    """What a task did not do: ``attempt`` passed or failed against expectation."""

    task: str
    attempt: str
    reason: str


@dataclass
class Report:
    """``disagreements``: where the eyes that looked count or answer otherwise than the task expects; they are told, not judged.

    ``absences``: core tasks whose answer is that there is none, each with a twin; ``from_start``: core tasks that need neither a
    move, nor a zoom, nor a sweep. ``guessed``: the core tasks that an answer passes which is given whatever was seen;
    ``whole``: how many these are, with pairs of an absence and a presence counting only when both pass.
    """

    tasks: int = 0
    by_category: Counter[str] = field(default_factory=Counter)
    by_stratum: Counter[str] = field(default_factory=Counter)
    passed: Counter[str] = field(default_factory=Counter)
    tried: Counter[str] = field(default_factory=Counter)
    absences: int = 0
    from_start: int = 0
    guessed: dict[str, set[str]] = field(default_factory=dict)
    whole: dict[str, int] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)
    cheated: list[Fault] = field(default_factory=list)
    disagreements: list[Fault] = field(default_factory=list)

    @property
    def cheat_shares(self) -> dict[str, float]:
        """Of each cheat the share of all tasks that it passes."""
        return {name: self.passed[name] / self.tasks for name in sorted(self.tried) if name not in _HONEST and self.tasks}

    @property
    def sound(self) -> bool:
        """Whether every reference and every other right way passed, and no cheat passed anything."""
        return bool(self.tasks) and not self.faults and not self.cheated

    def as_dict(self) -> dict[str, Any]:
        core = max(1, self.by_stratum["core"])
        return {
            "sound": self.sound,
            "tasks": self.tasks,
            "by_category": dict(self.by_category),
            "by_stratum": dict(self.by_stratum),
            "absences": self.absences,
            "from_start": self.from_start,
            "right_ways": {name: {"passed": self.passed[name], "of": self.tried[name]} for name in _HONEST if self.tried[name]},
            "cheats": {
                name: {"passed": self.passed[name], "of": self.tried[name], "share_of_all": share}
                for name, share in self.cheat_shares.items()
            },
            "looked_and_guessed": {
                name: {
                    "passed": len(ids),
                    "share": len(ids) / core,
                    "pairs_whole": self.whole[name],
                    "share_pairs_whole": self.whole[name] / core,
                }
                for name, ids in self.guessed.items()
            },
            "faults": [vars(fault) for fault in self.faults],
            "cheated": [vars(fault) for fault in self.cheated],
            "disagreements": [vars(fault) for fault in self.disagreements],
        }


_HONEST = ("reference", "detour", "twice", "worded")


async def validate(
    tasks: Sequence[Task],
    scenes: Mapping[str, Scene],
    equip: MakeToolContext,
    *,
    seed: int = 1,
    look: Look = view_truth,
    say: Say | None = None,
    beside: Sequence[Task] = (),
) -> Report:
    """Run everything on every task. Right ways are held to pass all, cheats to pass none.

    ``beside``: the dataset of which ``tasks`` are a selection; twins and reworded tasks may be there.

    ``look`` reads the truth of a view; one that remembers views saves most of the time.
    """
    report, common, usual = Report(), common_answers(tasks), common_answers(tasks, presences=True)
    siblings = sibling_answers(tasks)
    stages = {name: ProgramRunner(scene, equip, EYES) for name, scene in scenes.items()}
    world = ""
    # World by world, whose layers are let go of after it: all of them together are large.
    for number, task in enumerate(sorted(tasks, key=lambda task: task.world), 1):
        if world and world != task.world:
            scenes[world].release()
        world = task.world
        report.tasks += 1
        report.by_stratum[task.stratum] += 1
        if task.stratum == "core":
            report.by_category[task.category] += 1
            report.absences += isinstance(task.expected, NoneThere) and task.pair is not None
            report.from_start += not task.needs
        wrong = inconsistencies(task, scenes[task.world], look)
        report.faults += [Fault(task.id, "truth", reason) for reason in wrong]
        if task.preset not in {preset.name for preset in scenes[task.world].file.presets}:
            continue  # nothing can be run from there
        proof = _Proof(report, task, stages[task.world])
        await proof.run(common.get(task.category, "2"), siblings.get(task.id), seed)
        if task.stratum == "core":
            await proof.guess(usual.get(task.category, "2"))
        if say is not None:
            say(number, len(tasks))
    report.faults += structure(tasks, beside)
    _weigh_guesses(report, tasks)
    return report


def _weigh_guesses(report: Report, tasks: Sequence[Task]) -> None:
    """No answer may be right for both tasks of a pair, nor for too many tasks."""
    twins = {task.id: task.pair for task in tasks}
    core = report.by_stratum["core"]
    for name, ids in report.guessed.items():
        both = sorted(one for one in ids if twins[one] in ids)
        report.faults += [Fault(one, name, f"passes {twins[one]} as well") for one in both]
        report.whole[name] = len(both) + sum(twins[one] is None for one in ids)
        if core >= ENOUGH and report.whole[name] > MOST_GUESSED * core:
            report.faults.append(Fault("all", name, f"passes {report.whole[name]} of {core} tasks"))


class _Proof:
    """All attempts at one task. Programs that several attempts share are run once."""

    def __init__(self, report: Report, task: Task, stage: ProgramRunner) -> None:
        self.report, self.task, self.stage = report, task, stage
        self._ran: dict[str, Episode] = {}

    async def run(self, common: str, sibling: str | None, seed: int) -> None:
        for attempt in honest(self.task):
            await self._hold(attempt, attempt.name, passes=True)
        for text in right_texts(self.task):
            await self._hold(Attempt("worded", self.task.reference, text, self.task.behaviour.outcomes[0]), "worded", passes=True)
        self._compare(await self._episode(Attempt("reference", self.task.reference, "")))
        tried = set[str]()
        for attempt in cheats(self.task, common, sibling, random.Random(f"{seed}:{self.task.id}")):
            # Four guesses make one cheat: whichever passes counts once.
            again = attempt.name in tried
            tried.add(attempt.name)
            await self._hold(attempt, attempt.name, passes=False, again=again)

    async def guess(self, usual: str) -> None:
        """Which answers happen to be right."""
        for attempt in guesses(self.task, usual):
            passed = self.report.guessed.setdefault(attempt.name, set())
            if score_episode(self.task, await self._episode(attempt)).headline == "correct":
                passed.add(self.task.id)

    async def _episode(self, attempt: Attempt) -> Episode:
        key = str([(call.tool, call.arguments) for call in attempt.program])
        if key not in self._ran:
            self._ran[key] = await self.stage.run(self.task, attempt.program, attempt.text, attempt.outcome)
        return replace(self._ran[key], answer=attempt.text, outcome=attempt.outcome)

    async def _hold(self, attempt: Attempt, name: str, *, passes: bool, again: bool = False) -> None:
        verdict = score_episode(self.task, await self._episode(attempt))
        passed = verdict.headline == "correct"
        self.report.tried[name] += not again
        self.report.passed[name] += passed
        if passed != passes:
            reason = f"{attempt.text!r}: {verdict.reason}"
            (self.report.faults if passes else self.report.cheated).append(Fault(self.task.id, name, reason))

    def _compare(self, episode: Episode) -> None:
        """Whether what was counted and answered on the way is what the evidence shows."""
        if wrong_reads(self.task, episode):
            answers = "; ".join(str(call.result["answer"]) for call in episode.calls if call.result and "answer" in call.result)
            self.report.disagreements.append(Fault(self.task.id, "query", f"the evidence shows otherwise than: {answers}"))
        counts = [call for call in episode.calls if call.name == "count_objects" and call.result is not None]
        shows = [view.shows for view in self.task.evidence if isinstance(view.shows, Number | NoneThere)]
        for call, wanted in zip(counts, shows, strict=False):
            number = wanted.value if isinstance(wanted, Number) else 0
            told = (call.result or {}).get("count")
            if told != number:
                reason = f"count_objects({call.arguments['description']}) is {told}, the evidence shows {number:g}"
                self.report.disagreements.append(Fault(self.task.id, "count", reason))


def sibling_answers(tasks: Sequence[Task]) -> dict[str, str]:
    """For each task the right answer to another: its twin, else the next like it whose answer is another one."""
    by_id = {task.id: task for task in tasks}
    found = {}
    for at, task in enumerate(tasks):
        if isinstance(task.expected, ActionOnly):
            continue
        twin = by_id.get(task.pair or "")
        later = (*tasks[at + 1 :], *tasks[:at])
        others = [twin] if twin else [t for t in later if t.category == task.category and t.expected.kind == task.expected.kind]
        for other in others:
            text = right_answers(other.expected)[0]
            if agrees(task.expected, parse_answer(task.expected, text)) is not True:
                found[task.id] = text
                break
    return found


def structure(tasks: Sequence[Task], beside: Sequence[Task] = ()) -> list[Fault]:
    """What must hold between tasks: no text twice, twins that know each other, paraphrases of tasks that are there."""
    faults = []
    by_id = {task.id: task for task in (*beside, *tasks)}
    texts = Counter((task.world, task.preset, task.instruction.lower()) for task in tasks)
    for task in tasks:
        if texts[(task.world, task.preset, task.instruction.lower())] > 1:
            faults.append(Fault(task.id, "text", "another task says the same"))
        if task.pair is not None and (task.pair not in by_id or by_id[task.pair].pair != task.id):
            faults.append(Fault(task.id, "pair", f"{task.pair} is not its twin"))
        if (
            task.paraphrase_of is not None
            and (original := by_id.get(task.paraphrase_of)) is not None
            and original.expected != task.expected
        ):
            faults.append(Fault(task.id, "paraphrase", f"{task.paraphrase_of} expects something else"))
    return faults
