"""Task drafts: questions and commands that have no final wording and no id yet."""

from __future__ import annotations

import hashlib
import math
import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from scope_ptz.bench.tasks.expected import AnyExpected, Wordings
from scope_ptz.bench.tasks.task import Behaviour, Category, EvidenceView, Item, Need, ProgramCall
from scope_ptz.taskgen.authoring.noun_phrases import capitalise
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.facts.robust import TASK_CAMERA
from scope_ptz.tools.arguments import View

# Placeholders of the sentence frames: {d} is the question in direct form, and {i} is the question as a clause. {m} is a complete
# phrase for the moves, and {l} is a phrase for them to which "and ..." can be added. {D}, {M} and {L} begin with a capital letter.
# {p} is a preset.
_MOVE_PATTERNS = (
    "{M}. {D}", "{L} and tell me {i}.", "{L}, then tell me {i}.", "Please {l} and let me know {i}.", "{M}: {d}",
    "Could you {l} and report {i}?", "I'd like you to {m}. {D}", "{L} and find out {i}.", "First {m}. {D}",
    "I need to know {i}. {M} to see.", "{L} and have a look: {d}", "Tell me {i}. You will have to {m} for that.",
    "Can you {m}? {D}", "{L} and answer this: {d}", "For the log, {l} and note {i}.", "{D} To find out, {m}.",
    "Would you {l} and say {i}?", "Let me know {i}: {l} and look.",
)  # fmt: skip
_PRESET_PATTERNS = (
    "At the {p} preset, {d}", "From the {p} preset, {d}", "{D} Use the {p} preset.", "Check the {p} view: {d}",
    "Looking from the {p} preset, {d}", "In the {p} view, {d}", "Using the preset {p}, tell me {i}.",
)  # fmt: skip
_SWEEP_PATTERNS = (
    "In the whole scene, {d}", "Taking in everything around the camera, {d}", "{D} Consider the whole scene.",
    "All around the camera, {d}", "Over the full scene, tell me {i}.", "{D} Not in this view only, but all around.",
    "Looking in every direction, {d}",
)  # fmt: skip
_START_VIEW_PATTERNS = (
    "{D}", "In the current view, {d}", "In this view, tell me {i}.", "Looking straight at what the camera shows now, {d}",
    "Without moving the camera, {d}", "Right here in this view, {d}",
)  # fmt: skip


@dataclass(frozen=True)
class Question:
    """Wordings of a question, each as a direct question ("how many are there?") and as a clause ("how many there are")."""

    forms: tuple[tuple[str, str], ...]


def identical_forms(*questions: str) -> tuple[tuple[str, str], ...]:
    """Return the forms of questions that read the same as a direct question and as a clause ("which is nearer, ...")."""
    return tuple((question, question.rstrip("?")) for question in questions)


@dataclass(frozen=True)
class TaskDraft:
    """A task that has no final wording and no id yet.

    Attributes:
        category: The category of the task.
        question_type: The type of the question or command, such as "sum" or "close-up". The selection balances the types.
        key: A key for the question, so that it is asked only once about a view.
        place: Where the task starts, and the view that the task is about.
        expected: The expected answer.
        question: The wordings of the question; None for a task with ``instructions``.
        instructions: Complete wordings, for a task that is not a question about a place.
        evidence: The views from which the answer follows.
        perception_calls: The calls of the reference program that use perception.
        program: The reference program. By default, the calls of the place followed by ``perception_calls``.
        behaviour: What a run must do besides answering.
        needs: The actions that an agent must take before it can answer. By default, those of the place.
        tags: The task's tags.
        object_count: Number of objects that an agent must distinguish, which contributes to the difficulty.
        twin: For a draft about an absent object, the draft with the same wording about a present one.
        answer_key: The answer in short form. The selection balances the answers.
    """

    category: Category
    question_type: str
    key: str
    place: TaskPlace
    expected: AnyExpected
    question: Question | None = None
    instructions: tuple[str, ...] = ()
    evidence: tuple[EvidenceView, ...] = ()
    perception_calls: tuple[ProgramCall, ...] = ()
    program: tuple[ProgramCall, ...] | None = None
    behaviour: Behaviour | None = None
    needs: tuple[Need, ...] | None = None
    tags: tuple[str, ...] = ()
    object_count: int = 1
    twin: TaskDraft | None = None
    answer_key: str = ""

    @property
    def calls(self) -> tuple[ProgramCall, ...]:
        """The reference program."""
        return self.program if self.program is not None else (*self.place.calls, *self.perception_calls)

    @property
    def ends_zoomed(self) -> bool:
        """Whether the reference program ends at a close-up."""
        return any(call.tool == "zoom_to_object" for call in self.perception_calls)

    @property
    def moves_camera(self) -> bool:
        """Whether the reference program moves the camera or sweeps."""
        return self.place.swept or any(call.tool not in ("count_objects", "query_answer", "take_image") for call in self.calls)

    @cached_property
    def traits(self) -> tuple[tuple[str, str], ...]:
        """The traits that the selection balances: scene, viewpoints, question type, answer, subjects, view and start preset."""
        place = self.place
        seen = {view.aim.viewpoint for view in self.evidence} or {str(place.at.viewpoint)}
        return (
            ("scene", place.scene.name),
            *(("viewpoint", f"{place.scene.name}:{name}") for name in sorted(seen)),
            ("question type", self.question_type),
            ("answer", self.answer_key),
            *(("subject", name) for name in sorted({view.about[0] for view in self.evidence if view.about})),
            ("place", place.key),
            ("start", f"{place.scene.name}:{place.start}"),
        )

    @property
    def full_key(self) -> str:
        """A key for the question and the view together."""
        return f"{self.place.key}|{self.key}"

    def digest(self, seed: int | str) -> str:
        """Return a pseudo-random hexadecimal number for shuffling drafts. It depends only on the seed and this draft."""
        text = f"{seed}|{self.category}|{self.question_type}|{self.full_key}|{self.answer_key}|{self.place.start}"
        return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


class SentenceFrames:
    """A category's sentence frames, with the number of times each has been used.

    Frames are used equally often, and no text is used twice.

    A sentence frame is one wording of a question in one of the sentence patterns of this module, such as "First {m}. {D}".

    Args:
        texts: Instructions that are already used. ``record_use`` adds to this set.
    """

    def __init__(self, texts: set[str]) -> None:
        self.used: Counter[str] = Counter()
        self.texts = texts

    def word(self, draft: TaskDraft, rng: random.Random, frame_name: str | None = None) -> tuple[str, str] | None:
        """Phrase a draft with one of the least used frames.

        Args:
            draft: The draft.
            rng: Source of the random choices.
            frame_name: Name of the only frame to use, if the draft's twin already uses it; None for any frame.

        Returns:
            The instruction and the name of its frame; None if all wordings are used.
        """
        options = [o for o in self._options(draft, rng) if o[0] not in self.texts and (frame_name is None or o[1] == frame_name)]
        if not options:
            return None
        lowest = min(self.used[frame] for _, frame in options)
        text, frame = rng.choice([o for o in options if self.used[o[1]] == lowest])
        return text, frame

    def record_use(self, text: str, frame: str) -> None:
        """Record that a wording is used."""
        self.texts.add(text)
        self.used[frame] += 1

    def _options(self, draft: TaskDraft, rng: random.Random) -> list[tuple[str, str]]:
        if draft.question is None:
            return [(text, f"{draft.question_type}/{n}") for n, text in enumerate(draft.instructions)]
        place, options = draft.place, list[tuple[str, str]]()
        for n, (direct, clause) in enumerate(draft.question.forms):
            words = {"d": direct, "D": capitalise(direct), "i": clause}
            name = f"{draft.question_type}/{n}"
            if place.is_start_view:
                options += [(pattern.format(**words), f"{name}/stay{k}") for k, pattern in enumerate(_START_VIEW_PATTERNS)]
                continue
            if place.preset is not None and not place.swept:
                options += [
                    (pattern.format(p=place.preset, **words), f"{name}/preset{k}") for k, pattern in enumerate(_PRESET_PATTERNS)
                ]
            if place.swept and not place.calls:
                options += [(pattern.format(**words), f"{name}/around{k}") for k, pattern in enumerate(_SWEEP_PATTERNS)]
            for k, pattern in enumerate(_MOVE_PATTERNS):
                moves, before_and = place.move_phrases(rng)
                text = pattern.format(m=moves, M=capitalise(moves), l=before_and, L=capitalise(before_and), **words)
                options.append((text, f"{name}/{k}"))
        return options


def evidence_view(
    place: TaskPlace, shows: AnyExpected | None, about: Wordings, items: Sequence[Item] = (), *, whole: bool
) -> EvidenceView:
    """Return a place's view as evidence for an answer.

    Args:
        place: The view, or the sweep.
        shows: The answer that the view supports.
        about: Words for the subject of the evidence. A perception call must mention at least one of them.
        items: The objects from which the answer follows.
        whole: Whether the whole view is evidence, not only its items. A run must then observe all of it, with at least 60% of the
            pixels per degree that the place's view has.
    """
    density = place.truth.projection.pixels_per_radian * math.pi / 180
    return EvidenceView(
        aim=place.aim,
        scope="full" if place.swept else "current",
        hfov_deg=place.hfov_deg,
        band_deg=sweep_tilt_range() if place.swept else None,
        items=tuple(items),
        whole=whole,
        min_density_px_deg=round(0.6 * density, 3) if whole else 0.0,
        shows=shows,
        about=about,
    )


def sweep_tilt_range() -> tuple[float, float]:
    """Return the lowest and highest tilt in a sweep, in degrees."""
    sweep = TASK_CAMERA.sweep()
    return round(sweep.bottom_tilt_deg + 0.01, 2), round(sweep.top_tilt_deg, 2)


def scope_of(place: TaskPlace) -> View:
    """Return the scope for perception calls about a place."""
    return "full" if place.swept else "current"


def count_call(description: str, place: TaskPlace) -> ProgramCall:
    """Return a call that counts objects at a place."""
    return ProgramCall(tool="count_objects", arguments={"description": description, "view": scope_of(place)})


def query_call(question: str, place: TaskPlace) -> ProgramCall:
    """Return a call that asks perception a question about a place."""
    return ProgramCall(tool="query_answer", arguments={"question": capitalise(question), "view": scope_of(place)})


Difficulty = Literal["easy", "medium", "hard"]


def difficulty(calls: Sequence[ProgramCall], object_count: float, *, swept: bool) -> Difficulty:
    """Return the difficulty of a task.

    Args:
        calls: The calls of the reference program.
        object_count: Number of objects that an agent must distinguish.
        swept: Whether the task needs a sweep.
    """
    points = (len(calls) > 2) + (len(calls) > 4) + (object_count > 4) + (object_count > 9) + swept
    return "easy" if points == 0 else "medium" if points == 1 else "hard"
