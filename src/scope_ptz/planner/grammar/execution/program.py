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
from scope_ptz.planner.grammar.execution import move_sentences as motion
from scope_ptz.planner.grammar.execution.camera_history import VisitedPosition, is_same_pose
from scope_ptz.planner.grammar.execution.close_ups import CloseUpSteps
from scope_ptz.planner.grammar.execution.closer_look import is_too_small, reading_question, whole_of
from scope_ptz.planner.grammar.execution.comparisons import ComparisonSteps, stops_of_tour
from scope_ptz.planner.grammar.execution.move_arguments import arguments_of, return_arguments, unlimited_pose_after
from scope_ptz.planner.grammar.execution.returns import ReturnSteps
from scope_ptz.planner.grammar.execution.run_state import CallGenerator, HaltedError, Offer

_CAPABILITIES = (
    "I can pan, tilt and zoom, go to presets and home, take pictures, count things, answer questions about the scene, read text, "
    "and zoom in on or follow things"
)
_DEFAULT_MAX_MOVES = 24  # maximum number of moves of a loop if the instruction gives none
_SOMEONE = frozenset({"anyone", "anybody", "someone", "somebody", "people"})
_MAX_REQUESTED_MOVES = 100  # maximum number of moves of a loop that an instruction can request


class Program(CloseUpSteps, ReturnSteps, ComparisonSteps):
    """One run of the steps of an instruction, with one method for each step type."""

    def run(self, steps: Sequence[ast.Step]) -> CallGenerator:
        """Run all steps. After that, ``answer()`` returns the answer."""
        self.moves_are_forbidden = any(isinstance(step, ast.Forbid) and step.any_move for step in steps)
        is_home = not self.positions.earlier and self.pose == Pose()
        self._visited = [
            *self.positions.earlier, VisitedPosition(self.pose, self.positions.preset, is_home, self.viewpoint)
        ]  # fmt: skip
        try:
            yield from self._run_steps(steps)
        except HaltedError as halt:
            self._note(str(halt))
        if len(self.surveyed) > 1 and self.surveyed[-1] != self.positions.preset:
            self._note(f"The camera is now at {self.surveyed[-1]}")

    @property
    def offer(self) -> Offer | None:
        """The offer to go closer that can still be accepted, because the camera has not moved since."""
        return next((offer for offer in self.offers if offer.pose == self.pose), None)

    def _run_steps(self, steps: Sequence[ast.Step]) -> CallGenerator:
        steps, i = _with_counts_joined(steps), 0
        while i < len(steps):
            if len(stops := stops_of_tour(steps[i:])) > 1:
                yield from self._tour(stops)
                i += 2 * len(stops)
                continue
            yield from getattr(self, f"_{type(steps[i]).__name__.lower()}")(steps[i])
            i += 1

    # Motion ------------------------------------------------------------------------------------------------------------
    def _move(self, step: ast.Move) -> CallGenerator:
        if opposed := next((p for p in step.parts if isinstance(p, ast.Aim) and _is_in_wrong_direction(p, self.pose)), None):
            raise HaltedError(
                f"The zoom is {phrases.number(round(self.pose.zoom, 2))}x, so zooming {'in' if opposed.sense > 0 else 'out'} does "
                f"not lead to {phrases.number(opposed.value)}x; I left the zoom as it is"
            )
        arguments = arguments_of(step, self.pose, self.limits)
        if not arguments:
            self._note(f"The camera is already there: {phrases.pose_text(self.pose.as_dict())}")
            return
        start = self.pose
        result = yield from self._camera_call("adjust_ptz", **arguments)
        # Report a move that was cut short as the camera made it.
        shortfall = self._shortfall_text(result, unlimited_pose_after(arguments, start, self.limits))
        moved = return_arguments(self.pose, start, self.limits) if shortfall else arguments
        report = motion.report_of_move(arguments, moved, result, shortfall)
        is_still = is_same_pose(self.pose, start)
        self._note(report if is_still else f"{report}; the camera is now at {phrases.pose_text(result['pose'])}")

    def _record_position(self, preset: str | None, home: bool = False) -> None:
        self._visited.append(VisitedPosition(self.pose, preset, home, self.viewpoint))
        self._moved_to_object = False

    def _home(self, step: ast.Home) -> CallGenerator:
        result = yield from self._camera_call("go_home")
        self._went_home = True
        self._record_position(None, home=True)
        self._note(f"I went to the home view{motion.shortfall_text(result)}")

    def _gotopreset(self, step: ast.GoToPreset) -> CallGenerator:
        result = yield from self._camera_call("go_to_preset", name=step.ref.name)
        self._record_position(step.ref.name)
        self.stops.append(len(self.notes))
        self._note(f"I went to preset {step.ref.name}{motion.shortfall_text(result)}")

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
            if step.of.text in self._not_found:
                return
        for _ in range(step.times):
            result = yield from self._camera_call("take_image")
            self._note(f"I saved a picture as {result['file']}" if result.get("file") else "I saved a picture")

    def _track(self, step: ast.Track) -> CallGenerator:
        text = step.thing.text
        if text in self._not_found:
            return
        start = self.pose
        result = yield from self._perception_call("track_object", description=text, duration_s=_whole_as_int(step.seconds))
        if result is None:
            return
        self._last_was_yes = bool(result.get("found"))
        if not result.get("found"):
            self._not_found.add(text)
            self._note(f"I could not find {_the(step.thing)} to follow")
            return
        self._moved_to_object = True
        followed = "person" if text.lower() in _SOMEONE else phrases.noun(text, 1)
        seconds = phrases.number(result.get("duration_s", step.seconds))
        pronoun = phrases.object_pronoun(followed)
        time = motion.time_in_view(result.get("held_share", 0.0), result.get("duration_s", step.seconds))
        zoom = f". I zoomed {zoomed}" if (zoomed := motion.zoom_text(start.zoom, self.pose.zoom)) else ""
        self._note(f"I followed the {followed} for {seconds} seconds and had {pronoun} in view {time}{zoom}")

    def _count(self, step: ast.Count) -> CallGenerator:
        view, counts = step.view or "current", list[tuple[str, int, bool]]()
        for thing in step.things:
            result = yield from self._perception_call("count_objects", description=thing.text, view=view)
            self._last_was_yes = result["count"] > 0 if result is not None else None
            if result is not None and not result["count"] and not result.get("complete", True):
                self._note(phrases.not_made_out(thing.text, "from here"))
            elif result is not None:
                counts.append((thing.text, result["count"], result.get("complete", True)))
        if counts:
            self._note(f"I can see {phrases.all_counted(counts)}{phrases.where(view, [thing.text for thing in step.things])}")

    def _ask(self, step: ast.Ask, thing: str = "") -> CallGenerator:
        noted = len(self.notes)
        result = yield from self._answer_to(step.question, step.view or "current", thing)
        is_here = result is not None and result.get("known", True) and not phrases.reports_absence(str(result["answer"]))
        if step.otherwise_at is not None and not is_here:
            del self.notes[noted:]
            yield from self._gotopreset(ast.GoToPreset(step.otherwise_at))
            result = yield from self._answer_to(step.question, "current", thing)
        self._state_answer(result)

    def _state_answer(self, result: dict[str, Any] | None) -> None:
        self._last_was_yes = _said_yes(result)
        if result is not None:
            is_stated = result.get("known", True) or is_too_small(result) or result["answer"].lower().startswith("i cannot tell")
            self._note(result["answer"] if is_stated else f"I cannot tell: {phrases.with_lower_initial(result['answer'])}")

    def _read(self, step: ast.Read) -> CallGenerator:
        if step.thing.text in self._not_found:
            self._note("There was nothing to read")
            return
        yield from self._ask(ast.Ask(reading_question(step.thing.text), step.view), step.thing.text)

    def _lookcloser(self, step: ast.LookCloser) -> CallGenerator:
        result = yield from self._from_close_up(step.question, step.thing.text, None)
        if result is None:
            self._note(f"I could not find {_the(step.thing)} in this view, so the camera stayed where it was")
        self._state_answer(result)

    def _camerastate(self, step: ast.CameraState) -> CallGenerator:
        yield from ()
        here, pose = self._here(), phrases.pose_text(self.pose.as_dict())
        place = next((place for place in reversed(self._visited) if place.preset and place.viewpoint == self.viewpoint), None)
        if place is None:
            self._note(f"The camera is at {pose}")
        elif place.is_at(here) or place.pose == self.pose:
            self._note(f"The camera is at preset {place.preset}: {pose}")
        else:
            way = motion.offset_text(place.pose, self.pose)
            self._note(f"I am looking {way} preset {place.preset}: the camera is at {pose}")

    def _help(self, step: ast.Help) -> CallGenerator:
        yield from ()
        self._note(_CAPABILITIES)

    def _reply(self, step: ast.Reply) -> CallGenerator:
        yield from ()
        self._note(step.text)

    def _do_nothing(self, step: ast.Step) -> CallGenerator:
        yield from ()

    _sweep = _forbid = _report = _do_nothing

    # Control -----------------------------------------------------------------------------------------------------------
    def _repeat(self, step: ast.Repeat) -> CallGenerator:
        for _ in range(step.times):
            yield from self._run_steps(step.body)

    def _if(self, step: ast.If) -> CallGenerator:
        met, reason = yield from self._test(step.condition)
        self._last_was_yes = met
        branch = () if met is None else step.then if met else step.otherwise
        if branch:
            self._note(reason)
            yield from self._run_steps(branch)
        else:
            self._note(phrases.reason_and_reaction(reason, "did neither" if met is None and step.otherwise else "left it at that"))

    def _loop(self, step: ast.Loop) -> CallGenerator:
        if isinstance(step.until, ast.Readable) and step.bound is None and all(map(_zooms_in, step.body)):
            yield from self._zoom_in_to_read(step, step.until.thing)
            return
        limit, moves, best = self._move_limit(step), 0, -1
        last: dict[str, Any] = {}
        while True:
            met, reason = yield from self._test(step.until)
            best = max(best, self._last_count)
            if met is None and isinstance(step.until, ast.Negated):
                raise HaltedError(f"{reason}, so I stopped")  # "while" continues only as long as its condition is known to hold
            if met:
                self._note(f"{reason} after {motion.moves_text(last, moves)}" if moves else f"{reason} without having to move")
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
                    step, best, f": the camera reached its limit after {motion.moves_text(last, moves)}"
                )
                return
        yield from self._end_unmet_loop(step, best, f", and stopped after {motion.moves_text(last, moves)}")

    def _zoom_in_to_read(self, step: ast.Loop, thing: ast.Thing) -> CallGenerator:
        """Zoom in on a thing until its text can be read. If it cannot be read from close up either, put the camera back."""
        start, has_moved, whole = self.pose, False, whole_of(thing.text)
        met, reason = yield from self._test(step.until)
        targets = (thing.text, f"text on the {thing.text}") if whole == thing.text else (thing.text, whole, thing.text)
        for target in targets:
            if met or not is_too_small({"answer": reason, "known": False}) or not self._can_zoom_in():
                break
            zoomed = yield from self._perception_call("zoom_to_object", description=target)
            if zoomed is not None and zoomed.get("found"):
                has_moved = self._moved_to_object = True
                met, reason = yield from self._test(step.until)
        if met:
            self._note(f"I zoomed in on {_the(thing)}" if has_moved else "")
            self._note(reason)
            return
        if has_moved:
            self._note(f"I zoomed in on {_the(thing)}, but that did not help, so I put the camera back")
            yield from self._put_back(start)
        if not step.otherwise:
            raise HaltedError(reason)
        self._note(reason)
        yield from self._run_steps(step.otherwise)

    def _end_unmet_loop(self, step: ast.Loop, best: int, ending: str) -> CallGenerator:
        """End a loop whose condition was never met: run the alternative steps, or stop the run if there are none."""
        reason = f"I never {phrases.condition_text(step.until)}{_highest_count_text(best)}{ending}"
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


def _zooms_in(step: ast.Step) -> bool:
    """Return whether a step does nothing but zoom in."""
    return isinstance(step, ast.Move) and all(
        isinstance(part, ast.Zoom) and (part.kind == "in" or (part.kind == "factor" and part.value > 1)) for part in step.parts
    )


def _with_counts_joined(steps: Sequence[ast.Step]) -> list[ast.Step]:
    """Return steps in which neighbouring counts in the same view are one step, which is reported in one sentence."""
    joined: list[ast.Step] = []
    for step in steps:
        last = joined[-1] if joined else None
        if isinstance(step, ast.Count) and isinstance(last, ast.Count) and last.view == step.view:
            joined[-1] = ast.Count((*last.things, *step.things), step.view)
        else:
            joined.append(step)
    return joined


def _is_in_wrong_direction(aim: ast.Aim, pose: Pose) -> bool:
    """Return whether reaching a magnification needs a zoom in the other direction than stated: "zoom in to 2x" at 4x."""
    return aim.axis == "zoom" and aim.sense * (aim.value - pose.zoom) < 0


def _said_yes(result: dict[str, Any] | None) -> bool | None:
    """Return True if an answer is yes, False if it is no, and None if it is neither or unknown."""
    if result is None or not result.get("known", True):
        return None
    match = re.match(r"\W*(yes|no)\b", result["answer"], re.IGNORECASE)
    return match[1].lower() == "yes" if match else None


def _the(thing: ast.Thing) -> str:
    return f"the {thing.text}"


def _highest_count_text(best: int) -> str:
    return f" (the most was {best})" if best > 0 else ""


def _whole_as_int(value: float) -> float:
    return int(value) if float(value).is_integer() else value
