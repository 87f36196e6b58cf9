"""Environments whose episodes are runs of benchmark tasks, rewarded by the benchmark's checks."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Generic, TypeVar

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from scope_ptz.agent.records import Outcome
from scope_ptz.agent.store import NoImages
from scope_ptz.bench.program_runner import EpisodeRecorder
from scope_ptz.bench.scoring import episode as scoring
from scope_ptz.bench.scoring.checks import CheckResult, run_checks
from scope_ptz.bench.scoring.verdict import Verdict, score_episode
from scope_ptz.bench.tasks.task import Task
from scope_ptz.builtin_names import GROUND_TRUTH
from scope_ptz.errors import InputError
from scope_ptz.gym.move_actions import MoveScale, move_of, move_space
from scope_ptz.gym.observations import FRAME_SIZE, Observation, clean_text, frame_space, pose_array, pose_space, text_space
from scope_ptz.gym.rewards import CheckRewards
from scope_ptz.gym.task_choice import TaskChoice, other_requirement, select_tasks
from scope_ptz.gym.tool_actions import Call, Finish, decode_action, tool_space
from scope_ptz.gym.world import World
from scope_ptz.perception.base import Perception
from scope_ptz.tools.context import ToolContext

CAMERA_SIZE = (1280, 720)
"""Width and height, in pixels, of the frames that the tools take. The benchmark uses the same size."""
MAX_STEPS = 60  # T_max of the benchmark
_Action = TypeVar("_Action")
_CHECK_STATES = {True: "passed", False: "failed", None: "undecided"}


class _TaskEnv(gymnasium.Env[Observation, _Action], Generic[_Action]):
    """Base class for the task environments. An episode is one run of one task.

    The frames in observations count as looks by the agent, like the frames that a planner with vision receives. Whether a look
    shows enough of the evidence for a task depends on the frame size.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array"], "render_fps": 2}  # type: ignore[misc]

    def __init__(
        self,
        task: TaskChoice = "core",
        *,
        perception: str | Perception = GROUND_TRUTH,
        frame_size: tuple[int, int] = FRAME_SIZE,
        max_steps: int = MAX_STEPS,
        reward_weights: Mapping[str, float] | None = None,
        render_mode: str | None = None,
    ) -> None:
        """Create the environment. Scenes are opened when the first episode begins.

        Args:
            task: A task, a task id, the name of a split, or a sequence of these. Each episode samples one task.
            perception: The perception backend that the tools use: a name as accepted by ``--perception``, or a backend object.
            frame_size: Width and height of the observed frames in pixels.
            max_steps: Number of actions after which an episode is truncated.
            reward_weights: Reward weights that replace the defaults; see ``scope_ptz.gym.rewards``.
            render_mode: Either "rgb_array", in which case ``render`` returns the view at 1280x720, or None for no rendering.

        Raises:
            InputError: An argument is invalid.
        """
        if max_steps < 1:
            raise InputError(f"max_steps must be at least 1; got {max_steps}.")
        self._world = World(perception, frame_size, CAMERA_SIZE)
        self.tasks = self._filter_tasks(select_tasks(task))
        self.render_mode = render_mode
        self.observation_space = spaces.Dict(
            {"frame": frame_space(frame_size), "pose": pose_space(), "instruction": text_space(), "result": text_space()}
        )
        self._max_steps, self._rewards = max_steps, CheckRewards(reward_weights)
        self._steps, self._ended = 0, True

    def _filter_tasks(self, tasks: tuple[Task, ...]) -> tuple[Task, ...]:
        """Return the tasks that the actions of this environment can complete. Raises ``InputError`` if there are none."""
        return tasks

    @abstractmethod
    def _decode(self, action: _Action) -> Call | Finish:
        """Convert an action to a tool call, or to a ``Finish`` that ends the run."""

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode.

        Args:
            seed: Seed for the choice of the task and for the errors of noisy perception.
            options: ``{"task": ID}`` selects the task.
        """
        super().reset(seed=seed)
        chosen = (options or {}).get("task")
        tasks = self.tasks if chosen is None else self._filter_tasks(select_tasks(chosen))
        self.task = tasks[int(self.np_random.integers(len(tasks)))]
        self._world.open(self.task.world, self.task.preset, self.task.time_s, int(self.np_random.integers(2**31)))
        context = ToolContext(self._world.camera, self._world.perception, NoImages())
        self._recorder = self._world.run(
            lambda: EpisodeRecorder.begin(self.task.instruction, self._world.camera, context, self._world.camera_geometry)
        )
        self._steps, self._ended = 0, False
        observation = self._observe("", is_look=True)
        checks = self._checks()
        self._rewards.begin(checks)
        return observation, self._info(checks)

    def step(self, action: _Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Make a tool call, or end the run.

        Raises:
            InputError: The action is not an element of the action space, or no episode is running.
        """
        if self._ended:
            raise InputError("The episode has not begun, or it has ended. Call reset() before the next step.")
        decoded = self._decode(action)
        finish = decoded if isinstance(decoded, Finish) else None
        result = self._call(decoded) if isinstance(decoded, Call) else ""
        self._steps += 1
        terminated, truncated = finish is not None, finish is None and self._steps >= self._max_steps
        self._ended = terminated or truncated
        observation = self._observe(result, is_look=not self._ended)
        verdict = self._verdict(finish) if self._ended else None
        checks = self._checks() if verdict is None else verdict.checks
        terms = self._rewards.terms(checks, verdict)
        return observation, sum(terms.values()), terminated, truncated, self._info(checks, terms, verdict)

    def render(self) -> NDArray[np.uint8] | None:
        """Return the current view at 1280x720 as (H, W, 3) RGB; None without a render mode."""
        return None if self.render_mode is None else self._world.picture(self._recorder.position.pose, CAMERA_SIZE)

    def close(self) -> None:
        """Close perception and release the scenes."""
        self._world.close()

    def _call(self, call: Call) -> str:
        """Make a tool call and return its result in words."""
        outcome = self._world.run(lambda: self._recorder.call(call.name, call.arguments))
        return f"Error: {outcome.error}" if outcome.error is not None else str((outcome.result or {}).get("message", ""))

    def _observe(self, result: str, *, is_look: bool) -> Observation:
        """Return an observation. ``is_look`` is true if the agent can still act on the frame, so that it counts as a look."""
        world, position = self._world, self._recorder.position
        if is_look:
            view = world.geometry.view(position.pose)
            self._recorder.planner_views.append(scoring.Observation(position.viewpoint, view, world.time_s, "planner"))
        return {
            "frame": world.picture(position.pose),
            "pose": pose_array(position.pose),
            "instruction": clean_text(self.task.instruction),
            "result": clean_text(result),
        }

    def _checks(self) -> tuple[CheckResult, ...]:
        return run_checks(self.task, self._recorder.episode("", None))

    def _verdict(self, finish: Finish | None) -> Verdict:
        outcome: Outcome = "step_limit" if finish is None else finish.outcome
        return score_episode(self.task, self._recorder.episode("" if finish is None else finish.text, outcome))

    def _info(
        self, checks: tuple[CheckResult, ...], terms: Mapping[str, float] | None = None, verdict: Verdict | None = None
    ) -> dict[str, Any]:
        info: dict[str, Any] = {
            "task": self.task.id,
            "viewpoint": self._recorder.position.viewpoint,
            "scene_time_s": self._world.time_s,
            "checks": {check.name: _CHECK_STATES[check.passed] for check in checks},
            "reward_terms": dict(terms or {}),
        }
        if verdict is not None:
            info |= {"verdict": verdict.headline, "reason": verdict.reason}
        return info


class ToolTaskEnv(_TaskEnv[dict[str, Any]]):
    """``scope_ptz/Task-v0``: actions are the nine tools with their arguments, or an answer. See ``tool_action``."""

    def __init__(self, task: TaskChoice = "core", **options: Any) -> None:
        """Create the environment. The options are those of ``_TaskEnv``."""
        super().__init__(task, **options)
        self.action_space = tool_space()

    def _decode(self, action: dict[str, Any]) -> Call | Finish:
        return decode_action(action)


class MoveTaskEnv(_TaskEnv[NDArray[np.float32]]):
    """``scope_ptz/TaskContinuous-v0``: actions are continuous moves of pan, tilt and zoom. See ``move_action``.

    Each move is a call of ``adjust_ptz``. Only tasks that require nothing else can be selected; ``movement_tasks`` lists them.
    """

    def __init__(self, task: TaskChoice = "core", *, move_scale: MoveScale | None = None, **options: Any) -> None:
        """Create the environment. The other options are those of ``_TaskEnv``.

        Args:
            task: As in ``_TaskEnv``. Tasks in a split that require more than moves are omitted.
            move_scale: The size of the move that an action value of 1 represents, for each axis.
        """
        super().__init__(task, **options)
        self.action_space = move_space()
        self._scale = move_scale or MoveScale()

    def _filter_tasks(self, tasks: tuple[Task, ...]) -> tuple[Task, ...]:
        allowed = tuple(task for task in tasks if other_requirement(task) is None)
        if not allowed:
            raise InputError(
                f"The task {tasks[0].id} requires {other_requirement(tasks[0])}, which pan, tilt and zoom cannot provide. Use "
                "scope_ptz/Task-v0, or one of scope_ptz.gym.movement_tasks()."
            )
        return allowed

    def _decode(self, action: NDArray[np.float32]) -> Call | Finish:
        move = move_of(action, self._scale)
        if move.finish:
            return Finish("answered", "Done.")
        arguments = {"pan_deg": move.pan_deg, "tilt_deg": move.tilt_deg}
        return Call("adjust_ptz", arguments if move.zoom_factor == 1.0 else {**arguments, "zoom_factor": move.zoom_factor})
