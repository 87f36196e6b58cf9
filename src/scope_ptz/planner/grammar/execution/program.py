"""Run steps whose names are resolved. A program is a generator that yields tool calls and receives their outcomes.

It describes the results in words, which become the answer. At every step, the planner replays the generator against the recorded
history, so a program must depend only on its inputs.
"""

# ruff: noqa: ARG002 - all step methods share one signature

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any

from scope_ptz import english
from scope_ptz.geometry import Pose
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.execution import answer_sentences as phrases
from scope_ptz.planner.grammar.execution.camera_history import VisitedPosition
from scope_ptz.planner.grammar.execution.condition_evaluation import ConditionEvaluation, reading_question
from scope_ptz.planner.grammar.execution.move_arguments import arguments_of, return_arguments
from scope_ptz.planner.grammar.execution.run_state import CallGenerator, HaltedError

_CAPABILITIES = (
    "I can pan, tilt and zoom, go to presets and home, take pictures, count things, answer questions about the scene, read text, "
    "and zoom in on or follow things"
)
_DEFAULT_MAX_MOVES = 24  # maximum number of moves of a loop if the instruction gives none
_MAX_REQUESTED_MOVES = 100  # maximum number of moves of a loop that an instruction can request


class Program(ConditionEvaluation):
    """One run of the steps of an instruction, with one method for each step type."""

    def run(self, steps: Sequence[ast.Step]) -> CallGenerator:
        """Run all steps. After that, ``answer()`` returns the answer."""
        start = VisitedPosition(self.pose, self.positions.preset, home=self.positions.before is None and self.pose == Pose())
        self._visited = [self.positions.before, start] if self.positions.before else [start]
        try:
            yield from self._run_steps(steps)
        except HaltedError as halt:
            self._note(str(halt))

    def _run_steps(self, steps: Sequence[ast.Step]) -> CallGenerator:
        for step in steps:
            yield from getattr(self, f"_{type(step).__name__.lower()}")(step)

    # Motion ------------------------------------------------------------------------------------------------------------
    def _move(self, step: ast.Move) -> CallGenerator:
        if opposed := next((p for p in step.parts if isinstance(p, ast.Aim) and _is_opposed(p, self.pose)), None):
            raise HaltedError(
                f"The zoom is {phrases.number(round(self.pose.zoom, 2))}x, so zooming {'in' if opposed.sense > 0 else 'out'} does "
                f"not lead to {phrases.number(opposed.value)}x; I left the zoom as it is"
            )
        arguments = arguments_of(step, self.pose, self.limits)
        if not arguments:
            self._note(f"The camera is already there: {phrases.pose_text(self.pose.as_dict())}")
            return
        result = yield from self._camera_call("adjust_ptz", **arguments)
        text = f"{phrases.move_text(arguments)}; the camera is at {phrases.pose_text(result['pose'])}"
        self._note(phrases.sentence(text) + phrases.shortfall_text(result))

    def _back(self, step: ast.Back) -> CallGenerator:
        place = self._visited[-1]
        if step.zoom_only:
            yield from self._zoom_back(place)
        elif self._moved_to_object and (place.preset or (place.home and self._went_home)):
            yield from self._go_to(place)
        elif self._moved_to_object and self.assume_met:
            self._note("The camera goes back to where it was")
        elif return_arguments(place.pose, self.pose, self.limits):
            yield from self._return(place.pose)
        elif len(self._visited) > 1:
            self._visited.pop()
            yield from self._go_to(self._visited[-1])
        else:
            self._note("The camera is still where it was")

    def _zoom_back(self, place: VisitedPosition) -> CallGenerator:
        zoomed = Pose(self.pose.pan_deg, self.pose.tilt_deg, place.pose.zoom)
        if self._moved_to_object or not return_arguments(zoomed, self.pose, self.limits):
            yield from self._move(ast.Move((ast.Zoom("out"),)))
        else:
            yield from self._return(zoomed)

    def _return(self, pose: Pose) -> CallGenerator:
        arguments = return_arguments(pose, self.pose, self.limits)
        result = yield from self._camera_call("adjust_ptz", **arguments)
        self._note(f"{phrases.move_text(arguments)} to go back; the camera is at {phrases.pose_text(result['pose'])}")

    def _go_to(self, place: VisitedPosition) -> CallGenerator:
        if place.preset:
            yield from self._gotopreset(ast.GoToPreset(ast.PresetRef(place.preset)))
        elif place.home:
            yield from self._home(ast.Home())
        else:
            yield from self._return(place.pose)

    def _record_position(self, preset: str | None, home: bool = False) -> None:
        self._visited.append(VisitedPosition(self.pose, preset, home))
        self._moved_to_object = False

    def _home(self, step: ast.Home) -> CallGenerator:
        result = yield from self._camera_call("go_home")
        self._went_home = True
        self._record_position(None, home=True)
        self._note(phrases.sentence("I went to the home view") + phrases.shortfall_text(result))

    def _gotopreset(self, step: ast.GoToPreset) -> CallGenerator:
        result = yield from self._camera_call("go_to_preset", name=step.ref.name)
        self._record_position(step.ref.name)
        self._note(phrases.sentence(f"I went to preset {step.ref.name}") + phrases.shortfall_text(result))

    def _gothere(self, step: ast.GoThere) -> CallGenerator:
        if self._best_preset:
            yield from self._gotopreset(ast.GoToPreset(ast.PresetRef(self._best_preset)))
        else:
            self._note("There is no clear winner to go to")

    # Things ------------------------------------------------------------------------------------------------------------
    def _listpresets(self, step: ast.ListPresets) -> CallGenerator:
        result = yield from self._camera_call("get_presets")
        names = list(result.get("presets", ()))
        self._note(f"The presets are {english.listing(names)}" if names else "This camera has no presets")

    def _snap(self, step: ast.Snap) -> CallGenerator:
        if step.of is not None:
            yield from self._zoomto(ast.ZoomTo(step.of))
            if step.of.text in self._missing:
                return
        for _ in range(step.times):
            result = yield from self._camera_call("take_image")
            self._note(f"I saved a picture as {result['file']}" if result.get("file") else "I saved a picture")

    def _zoomto(self, step: ast.ZoomTo) -> CallGenerator:
        text = step.thing.text
        if text in self._missing:
            return
        result = yield from self._perception_call("zoom_to_object", description=text)
        self._last_was_yes = bool(result.get("found")) if result is not None else None
        if result is None or not result.get("found"):
            self._missing.add(text)
            if result is not None:
                self._note(f"I could not find {_the(step.thing)} in this view, so the camera stayed where it was")
            return
        self._moved_to_object = True
        many = f" ({result['matches']} matched; {result['chosen'] or 'one was chosen'})" if result.get("matches", 1) > 1 else ""
        limits = f", as far as the {english.listing(list(result['limited_by']))} limit allows" if result.get("limited_by") else ""
        self._note(f"I zoomed in on {_the(step.thing)}{many}{limits}")

    def _track(self, step: ast.Track) -> CallGenerator:
        text = step.thing.text
        if text in self._missing:
            return
        result = yield from self._perception_call("track_object", description=text, duration_s=_whole_as_int(step.seconds))
        if result is None:
            return
        self._last_was_yes = bool(result.get("found"))
        if not result.get("found"):
            self._missing.add(text)
            self._note(f"I could not find {_the(step.thing)} to follow")
            return
        self._moved_to_object = True
        share = round(100 * result.get("held_share", 0.0))
        seconds = phrases.number(result.get("duration_s", step.seconds))
        self._note(f"I followed {_the(step.thing)} for {seconds} seconds and had it in view {share}% of the time")

    def _count(self, step: ast.Count) -> CallGenerator:
        view = step.view or "current"
        for thing in step.things:
            result = yield from self._perception_call("count_objects", description=thing.text, view=view)
            self._last_was_yes = result["count"] > 0 if result is not None else None
            if result is not None:
                counts_text = phrases.counted(thing.text, result["count"], complete=result.get("complete", True))
                self._note(f"I can see {counts_text} {phrases.where(view)}")

    def _ask(self, step: ast.Ask) -> CallGenerator:
        result = yield from self._perception_call("query_answer", question=step.question, view=step.view or "current")
        self._last_was_yes = _said_yes(result)
        if result is not None:
            is_stated = result.get("known", True) or result["answer"].lower().startswith("i cannot tell")
            self._note(result["answer"] if is_stated else f"I cannot tell: {result['answer']}")

    def _read(self, step: ast.Read) -> CallGenerator:
        if step.thing.text in self._missing:
            self._note("There was nothing to read")
            return
        yield from self._ask(ast.Ask(reading_question(step.thing.text), step.view))

    def _camerastate(self, step: ast.CameraState) -> CallGenerator:
        yield from ()
        self._note(f"The camera is at {phrases.pose_text(self.pose.as_dict())}")

    def _help(self, step: ast.Help) -> CallGenerator:
        yield from ()
        self._note(_CAPABILITIES)

    def _do_nothing(self, step: ast.Step) -> CallGenerator:
        yield from ()

    _sweep = _forbid = _report = _do_nothing

    # Control -----------------------------------------------------------------------------------------------------------
    def _repeat(self, step: ast.Repeat) -> CallGenerator:
        for _ in range(step.times):
            yield from self._run_steps(step.body)

    def _if(self, step: ast.If) -> CallGenerator:
        met, reason = yield from self._test(step.condition)
        self._note(reason)
        self._last_was_yes = met
        if met is None:
            self._note("So I did neither" if step.otherwise else "So I did nothing further for that")
        elif met:
            yield from self._run_steps(step.then)
        elif step.otherwise:
            yield from self._run_steps(step.otherwise)
        else:
            self._note("So I did nothing further for that")

    def _loop(self, step: ast.Loop) -> CallGenerator:
        limit, moves, best = self._move_limit(step), 0, -1
        last: dict[str, Any] = {}
        while True:
            met, reason = yield from self._test(step.until)
            best = max(best, self._last_count)
            if met is None and isinstance(step.until, ast.Negated):
                raise HaltedError(f"{reason}, so I stopped")  # "while" goes on only as long as its condition is known to hold
            if met:
                self._note(f"{reason}, after {phrases.moves_text(last, moves)}" if moves else f"{reason}, without having to move")
                return
            if moves >= limit:
                break
            pose = self.pose
            for inner in step.body:
                if isinstance(inner, ast.Move):
                    last = arguments_of(inner, self.pose, self.limits, in_loop=True)
                    if last:
                        yield from self._camera_call("adjust_ptz", **last)
                else:
                    yield from self._run_steps([inner])
            moves += 1
            if self.pose == pose and any(isinstance(s, ast.Move) for s in step.body):
                yield from self._end_unmet_loop(
                    step, best, f": the camera reached its limit after {phrases.moves_text(last, moves)}"
                )
                return
        yield from self._end_unmet_loop(step, best, f", and stopped after {phrases.moves_text(last, moves)}")

    def _end_unmet_loop(self, step: ast.Loop, best: int, how: str) -> CallGenerator:
        """End a loop whose condition was never met: run the alternative steps, or stop the run if there are none."""
        reason = f"I never {phrases.condition_text(step.until)}{_highest_count_text(best)}{how}"
        if not step.otherwise:
            raise HaltedError(reason)
        self._note(reason)
        yield from self._run_steps(step.otherwise)

    def _move_limit(self, step: ast.Loop) -> int:
        """Return the limit on a loop's moves: that of the instruction, otherwise enough to cover the axis once, but at most 24."""
        bound = step.bound or ast.Bound()
        if bound.moves is not None:
            return min(bound.moves, _MAX_REQUESTED_MOVES)
        sizes = [arguments_of(s, self.pose, self.limits, in_loop=True) for s in step.body if isinstance(s, ast.Move)]
        pan = next((abs(a["pan_deg"]) for a in sizes if a.get("pan_deg")), 0.0)
        tilt = next((abs(a["tilt_deg"]) for a in sizes if a.get("tilt_deg")), 0.0)
        if bound.degrees is not None and (pan or tilt):
            return max(1, int(bound.degrees / (pan or tilt) + 1e-6))
        full_range_moves = math.ceil(358 / pan) if pan else math.ceil(90 / tilt) if tilt else _DEFAULT_MAX_MOVES
        return max(1, min(full_range_moves, _DEFAULT_MAX_MOVES))

    # Comparison --------------------------------------------------------------------------------------------------------
    def _compare(self, step: ast.Compare) -> CallGenerator:
        view = step.view or "current"
        first = yield from self._visible_count(step.first.text, view)
        second = yield from self._visible_count(step.second.text, view)
        self._last_was_yes = first > second if step.comparison == "more" else first < second
        counts_text = f"{phrases.counted(step.first.text, first)} and {phrases.counted(step.second.text, second)}"
        self._note(f"I can see {counts_text} {phrases.where(view)}")
        more, less = (step.first.text, step.second.text) if first > second else (step.second.text, step.first.text)
        self._note(
            "That is the same number of both"
            if first == second
            else f"There are more {phrases.noun(more, 2)} than {phrases.noun(less, 2)}"
        )

    def _beforeafter(self, step: ast.BeforeAfter) -> CallGenerator:
        text = step.thing.text
        before = yield from self._visible_count(text, "current")
        yield from self._run_steps(step.moves)
        after = yield from self._visible_count(text, "current")
        self._note(f"I can see {phrases.counted(text, before)} before the move and {phrases.counted(text, after)} after it")
        if before == after:
            self._note("The number is the same before and after")
        else:
            when = "before" if (before > after) == (step.comparison == "more") else "after"
            self._note(f"There are {step.comparison} {phrases.noun(text, 2)} {when} the move")

    def _whichpreset(self, step: ast.WhichPreset) -> CallGenerator:
        text, counts = step.thing.text, dict[str, int]()
        for place in step.places:
            yield from self._camera_call("go_to_preset", name=place.name)
            self._record_position(place.name)
            counts[place.name] = yield from self._visible_count(text, "current")
        self._note(f"I can see {english.listing([f'{phrases.counted(text, count)} at {name}' for name, count in counts.items()])}")
        if step.any_of:
            matching_presets = [name for name, count in counts.items() if count]
            self._last_was_yes = bool(matching_presets)
            self._note(
                f"{_capitalised_plural(text)} can be seen at {english.listing(matching_presets)}"
                if matching_presets
                else f"{_capitalised_plural(text)} can be seen at none of them"
            )
            self._best_preset = matching_presets[0] if matching_presets else None
            return
        best = (max if step.comparison == "more" else min)(counts.values())
        best_presets = [name for name, count in counts.items() if count == best]
        self._best_preset = best_presets[0] if len(best_presets) == 1 or self.assume_met else None
        superlative = (
            ("more" if step.comparison == "more" else "fewer")
            if len(counts) == 2
            else ("the most" if step.comparison == "more" else "the fewest")
        )
        verb = f"shows {superlative} {phrases.noun(text, 2)}"
        self._note(
            f"It is a tie between {english.listing(best_presets)}" if len(best_presets) > 1 else f"Preset {best_presets[0]} {verb}"
        )
        if step.go:
            yield from self._gothere(ast.GoThere())

    def _firstwith(self, step: ast.FirstWith) -> CallGenerator:
        for place in step.places:
            yield from self._camera_call("go_to_preset", name=place.name)
            self._record_position(place.name)
            count = yield from self._visible_count(step.thing.text, "current")
            if count or self.assume_met:
                self._best_preset, self._last_was_yes = place.name, True
                self._note(f"The first is {place.name}, where I can see {phrases.counted(step.thing.text, count)}")
                return
        self._best_preset, self._last_was_yes = None, False
        names = english.listing([place.name for place in step.places])
        self._note(f"I can see {phrases.counted(step.thing.text, 0)} at {names}")


def _capitalised_plural(text: str) -> str:
    """Return a description in the plural, with a capital first letter."""
    return phrases.sentence(phrases.noun(text, 2))[:-1]


def _is_opposed(aim: ast.Aim, pose: Pose) -> bool:
    """Return whether a magnification lies in the other direction than the instruction says: "zoom in to 2x" at 4x."""
    return aim.axis == "zoom" and aim.sense * (aim.value - pose.zoom) < 0


def _said_yes(result: dict[str, Any] | None) -> bool | None:
    """Return whether an answer is yes or no; None if it is neither or not known."""
    if result is None or not result.get("known", True):
        return None
    match = re.match(r"\W*(yes|no)\b", result["answer"], re.IGNORECASE)
    return match[1].lower() == "yes" if match else None


def _the(thing: ast.Thing) -> str:
    return f"the {thing.text}"


def _highest_count_text(best: int) -> str:
    return f" (the most was {best})" if best >= 0 else ""


def _whole_as_int(value: float) -> float:
    return int(value) if float(value).is_integer() else value
