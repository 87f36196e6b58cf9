"""Active search: find a named object anywhere around the camera with as few looks as possible, as in H*Bench (arXiv 2511.20351)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from scope_ptz.builtin_names import DEFAULT_SCENE, GROUND_TRUTH
from scope_ptz.errors import InputError
from scope_ptz.gym.move_actions import Move, MoveScale, move_of, move_space
from scope_ptz.gym.observations import Observation, clean_text, frame_space, pose_array, pose_space, text_space
from scope_ptz.gym.search_scores import search_score
from scope_ptz.gym.search_targets import Targets, is_central, true_boxes
from scope_ptz.gym.world import World
from scope_ptz.perception.base import Perception

FRAME_SIZE = (640, 360)
"""Default width and height of a frame in pixels. The size determines which objects are visible."""
MAX_LOOKS = 30
LOOK_COST = 0.01


class SearchEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """``scope_ptz/Search-v0``: turn and zoom until a named object is near the centre of the view, then submit.

    A look is a frame that the agent receives. The initial frame is the first look. An action either moves the camera and takes the
    next look, or submits the current view. A submission succeeds if the ground truth contains a visible object
    with the target's name in the middle third of the frame.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array"], "render_fps": 2}  # type: ignore[misc]

    def __init__(
        self,
        scene: str | Sequence[str] = DEFAULT_SCENE,
        *,
        targets: Sequence[str] = (),
        target_zoom: float = 1.0,
        perception: str | Perception | None = None,
        frames: bool = True,
        frame_size: tuple[int, int] = FRAME_SIZE,
        max_looks: int = MAX_LOOKS,
        look_cost: float = LOOK_COST,
        move_scale: MoveScale | None = None,
        render_mode: str | None = None,
    ) -> None:
        """Create the environment. Scenes are opened when the first episode begins.

        Args:
            scene: The scene, or several; each episode samples one of them, and the viewpoint of one of its presets.
            targets: Names of objects from which the target is sampled; by default, the names of all objects in the scene.
            target_zoom: The target is visible at this magnification when the camera points at it. Larger numbers allow
                smaller targets.
            perception: A perception backend (an object, or a name as in ``--perception``) that searches every frame for the
                target and adds ``detection`` to the observations. The default is no perception.
            frames: Whether observations contain frames. Without them, nothing is rendered, and training on detections is faster.
            frame_size: Width and height of the frames in pixels.
            max_looks: Maximum number of looks in an episode.
            look_cost: Amount by which each look after the first reduces the reward.
            move_scale: The size of the moves that actions of 1 represent.
            render_mode: "rgb_array", for which ``render`` returns the current view, or None.

        Raises:
            InputError: An argument is invalid.
        """
        self._names = (scene,) if isinstance(scene, str) else tuple(scene)
        if not self._names or max_looks < 1 or not math.isfinite(look_cost):
            raise InputError("A search needs at least one scene, at least one look, and a finite look_cost.")
        if not frames and perception is None:
            raise InputError("Without frames and without perception the agent sees nothing. Set perception, such as 'noisy'.")
        self._frames, self._has_detections, self._scale = frames, perception is not None, move_scale or MoveScale()
        self.max_looks, self._look_cost, self.render_mode = max_looks, look_cost, render_mode
        self._world = World(GROUND_TRUTH if perception is None else perception, frame_size, frame_size)
        self._targets = Targets(self._world, tuple(targets), target_zoom)
        self._ended = True
        parts: dict[str, spaces.Space[Any]] = {
            "pose": pose_space(),
            "target": text_space(),
            "looks_left": spaces.Box(0.0, 1.0, (1,), np.float32),
        }
        if frames:
            parts["frame"] = frame_space(frame_size)
        if self._has_detections:
            parts["detection"] = spaces.Box(0.0, 1.0, (5,), np.float32)
        self.observation_space = spaces.Dict(parts)
        self.action_space = move_space()

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        """Begin a search.

        Args:
            seed: Seed for the choice of scene, viewpoint, start and target, and for the errors of noisy perception.
            options: ``{"target": NAME}`` fixes the name of the target.
        """
        super().reset(seed=seed)
        rng, world = self.np_random, self._world
        name = self._names[int(rng.integers(len(self._names)))]
        file = world.scene_by_name(name).file
        preset = file.presets[int(rng.integers(len(file.presets)))].name
        world.open(name, preset, file.start_s, int(rng.integers(2**31)))
        start, self.target = self._targets.choose(rng, (options or {}).get("target"))
        world.place(start)
        self.looks, self._ended = 1, False
        return self._observe(), self._info({})

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Move and take the next look, or submit the current view.

        Raises:
            InputError: The action is not four finite numbers, or no episode is running.
        """
        if self._ended:
            raise InputError("The episode has not begun, or it has ended. Call reset() before the next step.")
        move = move_of(action, self._scale)
        terms: dict[str, float] = {}
        success: bool | None = None
        truncated = False
        if move.finish:
            success = any(map(is_central, true_boxes(self._world, self._world.pose, self.target)))
            terms = {"success": 1.0} if success else {}
        elif self.looks >= self.max_looks:
            success, truncated = False, True
        else:
            self._move(move)
            self.looks += 1
            terms = {"look": -self._look_cost} if self._look_cost else {}
        self._ended = success is not None
        return self._observe(), sum(terms.values()), move.finish, truncated, self._info(terms, success)

    def render(self) -> NDArray[np.uint8] | None:
        """Return the current view as (H, W, 3) RGB; None without a render mode."""
        return None if self.render_mode is None else self._world.picture(self._world.pose)

    def close(self) -> None:
        """Close perception and release the scenes."""
        self._world.close()

    def _move(self, move: Move) -> None:
        self._world.move(self._world.pose.turned(move.pan_deg, move.tilt_deg).zoomed(move.zoom_factor))

    def _observe(self) -> Observation:
        pose = self._world.pose
        observation: Observation = {
            "pose": pose_array(pose),
            "target": clean_text(self.target),
            "looks_left": np.array([1 - self.looks / self.max_looks], np.float32),
        }
        if self._frames:
            observation["frame"] = self._world.picture(pose)
        if self._has_detections:
            observation["detection"] = self._detection()
        return observation

    def _detection(self) -> NDArray[np.float32]:
        """Return whether perception detects the target, and the centre, width and height of the best box, all in [0, 1].

        Raises:
            PerceptionError: Perception failed. A failure is never reported as an empty view.
        """
        world = self._world
        frame = world.run(world.camera.frame)
        boxes = world.run(lambda: world.perception.detect(frame, self.target)).boxes
        if not boxes:
            return np.zeros(5, np.float32)
        return np.array([1.0, *boxes[0].centre, boxes[0].width, boxes[0].height], np.float32)

    def _info(self, terms: dict[str, float], success: bool | None = None) -> dict[str, Any]:
        info: dict[str, Any] = {
            "target": self.target,
            "scene": self._world.scene.name,
            "viewpoint": self._world.camera.viewpoint,
            "scene_time_s": self._world.time_s,
            "looks": self.looks,
            "reward_terms": terms,
        }
        if success is not None:
            info |= {"success": success, "score": search_score(success, self.looks, self.max_looks)}
        return info
