"""Zoom in on things, and return to the view from which the camera zoomed in when the next thing was chosen there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from scope_ptz.geometry import Pose
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.execution import answer_sentences as phrases
from scope_ptz.planner.grammar.execution import move_sentences as motion
from scope_ptz.planner.grammar.execution.camera_history import is_same_pose, pose_in
from scope_ptz.planner.grammar.execution.move_arguments import return_arguments
from scope_ptz.planner.grammar.execution.run_state import CallGenerator, RunState

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_AIMING = frozenset({"zoom_to_object", "track_object"})
_OTHER_PLACE = frozenset({"go_to_preset", "go_home"})
_WENT_BACK = "I went back to the view before"
_RETURN_FIRST = '. If it was in the view before, say "go back" first'


def view_before_close_ups(conversation: Sequence[PastTurn], now: Pose, viewpoint: str | None) -> Pose | None:
    """Return the pose from which the camera zoomed in on a thing, or followed it, if it has made no other move since.

    After several close-ups in a row, it is the pose before the first of them. None if anybody else has moved the camera.

    Args:
        conversation: The earlier turns.
        now: The camera's pose now.
        viewpoint: The camera's viewpoint now; None for a camera that has a single one.
    """
    wide: Pose | None = None
    nexts = [*((turn.start, turn.viewpoint) for turn in conversation[1:]), (now, viewpoint)]
    for turn, (next_start, next_viewpoint) in zip(conversation, nexts, strict=False):
        pose, before = turn.start, wide
        outcomes = [o for exchange in turn.exchanges for o in exchange.outcomes if o.error is None]
        for outcome in outcomes:
            after = pose_in(outcome.result)
            if after is None:
                continue
            has_moved = pose is None or not is_same_pose(pose, after)
            if outcome.call.name in _OTHER_PLACE or (has_moved and outcome.call.name not in _AIMING):
                wide = None
            elif has_moved and wide is None:
                wide = pose
            pose = after
        has_left = any(outcome.call.name in _OTHER_PLACE for outcome in outcomes)
        if pose is not None and turn.start is not None and is_same_pose(pose, turn.start):
            wide = None if has_left else before  # the camera was put back
        if pose is None or next_start is None or not is_same_pose(pose, next_start):
            wide = None
        if not has_left and turn.viewpoint != next_viewpoint:
            wide = None
    return wide


class CloseUpSteps(RunState):
    """The steps of a program that zoom in on things."""

    def _widerview(self, step: ast.WiderView) -> CallGenerator:  # noqa: ARG002 - all step methods share one signature
        """Return to the view before the close-ups, in which the things of the next steps were chosen."""
        if self._may_widen():
            yield from self._to_wider_view()
            self._note(_WENT_BACK)

    def _may_widen(self) -> bool:
        """Return whether the camera is at a close-up, and may leave it without a command.

        A real camera does not move for a reason that the user has not given.
        """
        return self.may_go_closer and not self.moves_are_forbidden and self.wider_view is not None

    def _to_wider_view(self) -> CallGenerator:
        arguments = return_arguments(self.wider_view or self.pose, self.pose, self.limits)
        self.wider_view = None
        if arguments:
            yield from self._camera_call("adjust_ptz", **arguments)

    def _zoomto(self, step: ast.ZoomTo) -> CallGenerator:
        text = step.thing.text
        if text in self._not_found:
            return
        start, result = self.pose, (yield from self._perception_call("zoom_to_object", description=text))
        views = "in this view"
        if result is not None and not result.get("found") and self.positions.start is not None and self._may_widen():
            # The user has seen the thing before the last close-up, and means that one.
            wider = self.wider_view
            yield from self._to_wider_view()
            result = yield from self._perception_call("zoom_to_object", description=text)
            if result is not None and result.get("found"):
                start = wider or start
                self._note(_WENT_BACK)
            else:
                if arguments := return_arguments(start, self.pose, self.limits):
                    yield from self._camera_call("adjust_ptz", **arguments)
                self.wider_view, views = wider, "in this view or in the one before"
        self._last_was_yes = bool(result.get("found")) if result is not None else None
        if result is None or not result.get("found"):
            self._not_found.add(text)
            if result is not None:
                hint = _RETURN_FIRST if self.wider_view is not None and not self.may_go_closer else ""
                has_gone_back = self.notes[-1:] == [_WENT_BACK]
                stays = ", so the camera is back at the view before" if has_gone_back else ", so the camera stayed where it was"
                if self.notes and self.notes[-1].startswith(motion.WENT_BACK_TO):
                    stays = ""  # the camera has moved, and the answer says where it is
                if has_gone_back:
                    self.notes.pop()
                self._note(f"I could not find the {text} {views}{stays}{hint}")
            return
        self._note_close_up(step.thing, start, result)

    def _note_close_up(self, thing: ast.Thing, start: Pose, result: dict[str, Any]) -> None:
        """Note a close-up in the answer, and from where the camera zoomed in."""
        self._moved_to_object = True
        self.wider_view = self.wider_view or start
        matches = result.get("matches", 1)
        target = phrases.chosen_text(thing.text, matches, result.get("chosen", "")) if matches > 1 else f"the {thing.text}"
        limits = f", as far as the {motion.limits_text(result['limited_by'])}" if result.get("limited_by") else ""
        self._note(f"I zoomed in on {target}{limits}")
