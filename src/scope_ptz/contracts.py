"""Public types for implementing a camera, a planner or a perception backend.

- A camera subclasses ``Camera`` and returns ``CameraInfo``, ``PresetInfo``, ``Arrival`` and ``Frame``. It has a ``Clock``;
  real cameras use ``WallClock``. ``Limits``, ``Optics``, ``Pose`` and ``Perspective`` describe its geometry. The camera's
  ``Capabilities`` state whether it can be driven at a ``Velocity``, whether its presets can be edited, and how its focus and iris
  can be set; these are returned as a ``LensState``.
- A planner subclasses ``Planner``. Its ``step`` receives a ``State`` and returns ``CallTools`` (of ``ToolCall``) or ``Finish``.
- A perception backend subclasses ``Perception`` and returns ``Caption``, ``Answer``, ``Detections`` (of ``Box``) and ``Points``
  (of ``Point``). It raises ``PerceptionError`` when it cannot process a frame.

The test suites ``scope_ptz.CameraConformance`` and ``scope_ptz.PerceptionConformance`` check an implementation.
"""

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.camera.capabilities import Capabilities, Velocity
from scope_ptz.camera.clocks import Clock, WallClock
from scope_ptz.camera.lens import LensState
from scope_ptz.errors import CameraError, PerceptionError, PlannerError, UnknownNameError
from scope_ptz.geometry import Limits, Optics, Perspective, Pose
from scope_ptz.perception.base import Answer, Box, Caption, Detections, Perception, Point, Points
from scope_ptz.planner.base import CallTools, Decision, Exchange, Finish, Planner, State, ToolCall, ToolOutcome

__all__ = [
    "Answer",
    "Arrival",
    "Box",
    "CallTools",
    "Camera",
    "CameraError",
    "CameraInfo",
    "Capabilities",
    "Caption",
    "Clock",
    "Decision",
    "Detections",
    "Exchange",
    "Finish",
    "Frame",
    "LensState",
    "Limits",
    "Optics",
    "Perception",
    "PerceptionError",
    "Perspective",
    "Planner",
    "PlannerError",
    "Point",
    "Points",
    "Pose",
    "PresetInfo",
    "State",
    "ToolCall",
    "ToolOutcome",
    "UnknownNameError",
    "Velocity",
    "WallClock",
]
