"""Steps that return to an earlier position, and steps that are carried out in place of the previous command."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from scope_ptz.geometry import Pose
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.execution import answer_sentences as phrases
from scope_ptz.planner.grammar.execution import move_sentences as motion
from scope_ptz.planner.grammar.execution.camera_history import VisitedPosition, is_same_pose
from scope_ptz.planner.grammar.execution.move_arguments import arguments_of, return_arguments, unlimited_pose_after
from scope_ptz.planner.grammar.execution.run_state import CallGenerator, HaltedError, RunState

_NO_WAY_BACK = "I cannot go back there: that was another viewpoint, and no preset leads to it"


class ReturnSteps(RunState):
    """The steps of a program that depend on where the camera was before."""

    @abstractmethod
    def _run_steps(self, steps: Sequence[ast.Step]) -> CallGenerator:
        """Run steps."""

    @abstractmethod
    def _move(self, step: ast.Move) -> CallGenerator:
        """Make a relative or absolute move."""

    @abstractmethod
    def _record_position(self, preset: str | None, home: bool = False) -> None:
        """Record the camera's position, so that later steps can return to it."""

    def _back(self, step: ast.Back) -> CallGenerator:
        place = self._visited[-1]
        if step.to_start:
            yield from self._back_to_start()
        elif step.zoom_only:
            yield from self._zoom_back()
        elif self._moved_to_object and (place.preset or (place.home and self._went_home)):
            yield from self._go_back_to(place)
        elif self._moved_to_object and self.assume_met:
            self._note("The camera goes back to where it was")
        elif step.again and self.positions.left is not None and len(self._visited) == len(self.positions.earlier) + 1:
            yield from self._go_back_to(self.positions.left)
        else:
            yield from self._undo()

    def _undo(self) -> CallGenerator:
        """Return to the last position that differs from the current one, and forget the positions after it."""
        last = self._visited[-1]
        if not last.is_at(self._here()) and last.viewpoint == self.viewpoint:
            yield from self._turn_back(last.pose)
            return
        earlier = self._visited[:-1]
        while earlier and earlier[-1].is_at(self._here()) and not self.assume_met:  # a plan only assumes where presets are
            earlier.pop()
        if earlier:
            self._visited = earlier
            yield from self._go_back_to(earlier[-1])
        else:
            start = self.positions.start
            if start is not None and not start.is_at(self._here()):
                self._note("I no longer know an earlier position to go back to")
                return
            where = "where it started" if start is not None else "where it was"
            self._note(f"There is no earlier position to go back to: the camera is still {where}")

    def _back_to_start(self) -> CallGenerator:
        start = self.positions.start or self._visited[0]
        if start.is_at(self._here()):
            self._note(f"The camera is already where we started: {phrases.pose_text(self.pose.as_dict())}")
        else:
            yield from self._go_back_to(start)

    def _zoom_back(self) -> CallGenerator:
        """Return to the magnification before the last zoom; without one, zoom out all the way."""
        places = [place for place in reversed(self._visited) if place.viewpoint == self.viewpoint]
        zooms = [Pose(self.pose.pan_deg, self.pose.tilt_deg, place.pose.zoom) for place in places]
        before = next((pose for pose in zooms if return_arguments(pose, self.pose, self.limits)), None)
        if before is None or self._moved_to_object:
            yield from self._move(ast.Move((ast.Zoom("out"),)))
        else:
            yield from self._turn_back(before)

    def _go_back_to(self, place: VisitedPosition) -> CallGenerator:
        """Go to an earlier position. That of another viewpoint is reached by way of a preset there."""
        is_other = place.viewpoint != self.viewpoint
        if place.preset:
            result = yield from self._camera_call("go_to_preset", name=place.preset)
            self._record_position(place.preset)
            self._note(motion.report_of_return(f"preset {place.preset}", motion.shortfall_text(result)))
        elif place.home:
            result = yield from self._camera_call("go_home")
            self._went_home = True
            self._record_position(None, home=True)
            self._note(motion.report_of_return("the home view", motion.shortfall_text(result)))
        elif not is_other and place.viewpoint != "":
            yield from self._turn_back(place.pose)
        else:
            of_presets = self.viewpoints.of_presets if self.viewpoints is not None else {}
            preset = next((name for name, viewpoint in of_presets.items() if viewpoint == place.viewpoint), None)
            if preset is None:
                raise HaltedError(_NO_WAY_BACK)
            yield from self._camera_call("go_to_preset", name=preset)
            if arguments := return_arguments(place.pose, self.pose, self.limits):
                yield from self._camera_call("adjust_ptz", **arguments)
            self._note(motion.report_of_return(phrases.pose_text(self.pose.as_dict())))

    def _turn_back(self, pose: Pose) -> CallGenerator:
        """Return to a pose of the current viewpoint."""
        result = yield from self._camera_call("adjust_ptz", **return_arguments(pose, self.pose, self.limits))
        self._note(motion.report_of_return(phrases.pose_text(result["pose"]), self._shortfall_text(result, pose)))

    def _instead(self, step: ast.Instead) -> CallGenerator:
        """Run steps from the position before the previous command."""
        start = self.positions.corrected
        if isinstance(step.steps[0], ast.GoToPreset):
            yield from self._run_steps(step.steps)
        elif start is None or start.viewpoint != self.viewpoint or start.viewpoint == "":
            raise HaltedError("I cannot tell where the camera was before the last command, so I did nothing")
        elif len(step.steps) == 1 and isinstance(step.steps[0], ast.Move):
            yield from self._move_instead(step.steps[0], start.pose)
        else:
            if not start.is_at(self._here()):
                wider = self.wider_view
                yield from self._turn_back(start.pose)
                is_close_up = wider is not None and not is_same_pose(wider, start.pose)
                self.wider_view = wider if is_close_up else None  # the corrected close-up may have followed another one
            yield from self._run_steps(step.steps)

    def _move_instead(self, move: ast.Move, start: Pose) -> CallGenerator:
        """Move to where a move from another start would have led, and say what the camera did instead of the corrected move."""
        wanted, before = unlimited_pose_after(arguments_of(move, start, self.limits), start, self.limits), self.pose
        target, clamped = self.limits.clamp(wanted)
        arguments = return_arguments(target, before, self.limits)
        limits = f", as far as the {motion.limits_text(clamped)}" if clamped else ""
        if not arguments and clamped:
            self._note(motion.report_of_move(arguments_of(move, start, self.limits), {}, {"clamped": clamped}, limits))
            return
        if not arguments:
            self._note(f"The camera is already there: {phrases.pose_text(self.pose.as_dict())}")
            return
        result = yield from self._camera_call("adjust_ptz", **arguments)
        moved = motion.move_text(return_arguments(self.pose, before, self.limits))
        made = return_arguments(self.pose, start, self.limits)
        total = f"so the camera has {motion.move_text(made)} instead" if made else "so the camera is back where it was"
        report = f"I {moved}{self._shortfall_text(result, target) or limits}"
        pose = phrases.pose_text(result["pose"])
        self._note(
            f"{report}; the camera is now at {pose}" if is_same_pose(before, start) else f"{report}, {total}; it is now at {pose}"
        )
