"""Single-call tasks, which require one tool call: moves, presets, home, pictures, close-ups, tracking and counts."""

from __future__ import annotations

import random
from collections.abc import Iterator

from scope_ptz.bench.tasks.expected import ActionOnly, Number
from scope_ptz.bench.tasks.task import Argument, Behaviour, Category, Need, ProgramCall, RequiredCall
from scope_ptz.simulator.models import SceneActor
from scope_ptz.taskgen.authoring.drafts import Question, TaskDraft, count_call, evidence_view
from scope_ptz.taskgen.authoring.noun_phrases import answer_words, capitalise, object_words, plural_noun, singular_noun
from scope_ptz.taskgen.authoring.object_names import nameable_things
from scope_ptz.taskgen.authoring.task_places import (
    ScenePlaces,
    TaskPlace,
    adjust_call,
    apply_adjustment,
    call_phrases,
    preset_call,
    preset_position,
)
from scope_ptz.taskgen.authoring.view_contents import countable_kinds
from scope_ptz.taskgen.authoring.zoom_targets import target_framing
from scope_ptz.taskgen.facts.kinds import Kind
from scope_ptz.taskgen.facts.robust import TRACE_PX

_POLITE_FORMS = ("{M}.", "Please {m}.", "{M}, please.", "Could you {m}?", "I need you to {m}.", "{M} now.", "Now {m}.")


def polite_forms(request: str) -> tuple[str, ...]:
    """Return a request in several polite forms."""
    return tuple(form.format(m=request, M=capitalise(request)) for form in _POLITE_FORMS)


def command_draft(
    category: Category,
    question_type: str,
    key: str,
    place: TaskPlace,
    instructions: tuple[str, ...],
    program: tuple[ProgramCall, ...],
    behaviour: Behaviour,
    needs: tuple[Need, ...],
    tags: tuple[str, ...] = (),
) -> TaskDraft:
    """Return a command draft. A command has no expected answer; its score depends on what the camera does."""
    return TaskDraft(
        category=category,
        question_type=question_type,
        key=key,
        place=place,
        expected=ActionOnly(),
        instructions=instructions,
        program=program,
        behaviour=behaviour,
        needs=needs,
        tags=("command", *tags),
        answer_key=question_type,
    )


def drafts(places: ScenePlaces, target_places: list[TaskPlace], rng: random.Random) -> Iterator[TaskDraft]:
    """Yield drafts of all types in turn. Close-up and tracking drafts are about ``target_places``."""
    streams = [
        _move_drafts(places, rng),
        _preset_drafts(places, rng),
        _pan_drafts(places, rng),
        _close_up_drafts(target_places),
        _tracking_drafts(target_places),
        _sweep_drafts(places),
        _move_drafts(places, rng),
        _other_command_drafts(places, rng),
        _tilt_drafts(places, rng),
    ]
    while streams:
        for stream in list(streams):
            draft = next(stream, None)
            if draft is None:
                streams.remove(stream)
            else:
                yield draft


def _adjustment_draft(
    places: ScenePlaces, name: str, call: ProgramCall, question_type: str, rng: random.Random
) -> TaskDraft | None:
    start = places.place_at_preset(name)
    destination = apply_adjustment(start.at, call)
    if destination is None:
        return None
    end = TaskPlace(start.scene, name, (call,), destination)
    instructions = tuple(dict.fromkeys(text for _ in range(4) for text in polite_forms(" and ".join(call_phrases(call, rng)))))
    return command_draft(
        "single_call", question_type, f"adjust:{end.key}", start, instructions, (call,), Behaviour(final=end.final), end.needs
    )


def _move_drafts(places: ScenePlaces, rng: random.Random) -> Iterator[TaskDraft]:
    """Yield zooms, and moves that combine two of pan, tilt and zoom."""
    names = list(places.presets)
    for n in range(60):
        pan, tilt, factor = (
            rng.choice((-1, 1)) * rng.choice((8, 12, 16, 22, 35, 55)),
            rng.choice((-14, -9, -6, 5, 7, 9)),
            rng.choice((1.2, 1.5, 1.8, 2.0, 2.5, 3.0)),
        )
        call = (adjust_call(factor=factor), adjust_call(pan, tilt), adjust_call(pan, 0, factor))[n % 3]
        draft = _adjustment_draft(places, names[n % len(names)], call, ("zoom", "turn-both", "turn-zoom")[n % 3], rng)
        if draft is not None:
            yield draft


def _pan_drafts(places: ScenePlaces, rng: random.Random) -> Iterator[TaskDraft]:
    names = list(places.presets)
    for _ in range(40):
        amount = rng.choice((-1, 1)) * rng.choice((5, 8, 15, 20, 24, 33, 45, 65, 80, 100))
        draft = _adjustment_draft(places, rng.choice(names), adjust_call(amount), "pan", rng)
        if draft is not None:
            yield draft


def _tilt_drafts(places: ScenePlaces, rng: random.Random) -> Iterator[TaskDraft]:
    names = list(places.presets)
    for _ in range(30):
        draft = _adjustment_draft(
            places, rng.choice(names), adjust_call(0, rng.choice((-18, -11, -7, -4, 3, 6, 9, 12))), "tilt", rng
        )
        if draft is not None:
            yield draft


def _preset_drafts(places: ScenePlaces, rng: random.Random) -> Iterator[TaskDraft]:
    for name, preset in places.presets.items():
        starts = [other for other in places.presets if other != name]
        if not starts:
            continue
        start = places.place_at_preset(rng.choice(starts))
        end = TaskPlace(start.scene, start.start, (preset_call(name),), preset_position(preset))
        instructions = tuple(
            dict.fromkeys(text for _ in range(4) for text in polite_forms(call_phrases(preset_call(name), rng)[0]))
        )
        yield command_draft(
            "single_call",
            "preset",
            f"go:{name}",
            start,
            instructions,
            (preset_call(name),),
            Behaviour(final=end.final),
            ("preset",),
        )


def _other_command_drafts(places: ScenePlaces, rng: random.Random) -> Iterator[TaskDraft]:
    """Yield commands to go home, to take a picture, and to list the presets."""
    scene, home = places.scene, places.scene.file.home_preset
    others = [name for name in places.presets if name != home]
    rng.shuffle(others)
    for n, name in enumerate(others[:3]):
        start = places.place_at_preset(name)
        final = TaskPlace(scene, name, (), preset_position(places.presets[home])).final
        wordings = ("go home", "return to the home position", "take the camera back home", "move back to the home view")
        instructions = tuple(text for wording in wordings for text in polite_forms(wording))
        yield command_draft(
            "single_call",
            "home",
            f"home:{name}",
            start,
            instructions,
            (ProgramCall(tool="go_home"),),
            Behaviour(final=final),
            ("preset",),
        )
        picture_instructions = tuple(
            f"{w} of the {name} view{e}"
            for w in ("Take a picture", "Save a still", "Capture an image", "Take a snapshot")
            for e in (".", ", please.", " as it is now.")
        )
        yield command_draft(
            "single_call",
            "picture",
            f"picture:{name}",
            start,
            picture_instructions,
            (ProgramCall(tool="take_image"),),
            Behaviour(final=start.final, calls=(RequiredCall(tool="take_image"),), pictures=1),
            (),
            ("picture",),
        )
        if n == 0:
            instructions = (
                f"Which presets are stored for {scene.file.title}?",
                f"List the preset views of {scene.file.title}.",
                f"What views have been saved for the camera at {scene.file.title}?",
            )
            calls = (ProgramCall(tool="get_presets"),)
            behaviour = Behaviour(calls=(RequiredCall(tool="get_presets"),), final=start.final)
            yield command_draft("single_call", "list", "presets", start, instructions, calls, behaviour, (), ("presets",))


def _close_up_drafts(target_places: list[TaskPlace]) -> Iterator[TaskDraft]:
    for place in target_places:
        if not place.is_start_view and place.preset is None:
            continue
        current_place = TaskPlace(place.scene, place.preset or place.start, (), place.at)
        for target in nameable_things(place.truth, 400):
            required_framing = target_framing(current_place, target.thing, target.thing.instance)
            if required_framing is None or len(target.thing.instance.attributes) == 0:
                continue
            instructions = tuple(
                t
                for w in (
                    f"zoom in on {target.with_the}",
                    f"get a close-up of {target.with_the}",
                    f"frame {target.with_the}",
                    f"centre {target.with_the} and zoom in on it",
                )
                for t in polite_forms(w)
            )
            call = ProgramCall(tool="zoom_to_object", arguments={"description": target.name})
            yield command_draft(
                "single_call",
                "close-up",
                f"close-up:{target.thing.instance.id}",
                current_place,
                instructions,
                (call,),
                Behaviour(framing=required_framing),
                ("zoom",),
                ("framing",),
            )


def _tracking_drafts(target_places: list[TaskPlace]) -> Iterator[TaskDraft]:
    """Yield commands to follow a moving object that is the only one of its kind and is still in view 1.5 s later."""
    for n, place in enumerate(target_places):
        current_place = TaskPlace(place.scene, place.preset or place.start, (), place.at)
        at_start = current_place.truth.samples[0]
        later = current_place.truth.read_truth(
            current_place.scene, str(current_place.at.viewpoint), current_place.truth.projection, current_place.truth.time_s + 1.5
        )
        for sighting in at_start.visible:
            actor = sighting.instance
            kind = Kind(actor.category)
            if not isinstance(actor, SceneActor) or sighting.pixels < 600 or sighting.visible_fraction < 0.9:
                continue
            others = [s for s in at_start.sightings if s.instance is not actor]
            rivals = [s for s in others if kind.fits(s.instance) or kind.is_ambiguous_with(s.instance)]
            if any(s.pixels > TRACE_PX for s in rivals) or actor.number not in {s.instance.number for s in later.visible}:
                continue
            seconds = (4.0, 5.0, 6.0, 8.0)[n % 4]
            wordings = (
                f"follow the {kind.category} for {seconds:g} seconds",
                f"keep the {kind.category} in view for {seconds:g} seconds",
                f"track the {kind.category} for the next {seconds:g} seconds",
            )
            call = ProgramCall(tool="track_object", arguments={"description": kind.category, "duration_s": seconds})
            required = {"description": Argument(mentions=answer_words(kind)), "duration_s": Argument(equals=seconds, within=0.5)}
            yield command_draft(
                "single_call",
                "follow",
                f"follow:{actor.id}",
                current_place,
                tuple(text for wording in wordings for text in polite_forms(wording)),
                (call,),
                Behaviour(calls=(RequiredCall(tool="track_object", arguments=required),)),
                ("move",),
                ("moving",),
            )


def _sweep_drafts(places: ScenePlaces) -> Iterator[TaskDraft]:
    for place in places.sweeps():
        if place.calls:
            continue
        for kind, number in countable_kinds(place.truth)[:40]:
            many = plural_noun(kind)
            expected = Number(value=number, unit=answer_words(kind))
            items = [place.truth.item(t, True) for t in place.truth.all_of(kind) or ()]
            yield TaskDraft(
                category="single_call",
                question_type="count-all",
                key=f"count:{singular_noun(kind)}",
                place=place,
                expected=expected,
                question=Question(
                    (
                        (f"how many {many} are there in all?", f"how many {many} there are in all"),
                        (f"what is the total of {many}?", f"the total of {many}"),
                    )
                ),
                evidence=(evidence_view(place, expected, object_words(kind), items, whole=True),),
                perception_calls=(count_call(many, place),),
                tags=("full",),
                object_count=number,
                answer_key=str(number),
            )
