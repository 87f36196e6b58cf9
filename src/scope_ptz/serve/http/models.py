"""Request and response bodies for the API."""

from __future__ import annotations

import re
from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from scope_ptz.camera.base import Arrival
from scope_ptz.camera.capabilities import MAX_DRIVE_TIMEOUT_S
from scope_ptz.geometry import Pose
from scope_ptz.planner.limits import MAX_INSTRUCTION_CHARS
from scope_ptz.serve.site.clients import Role
from scope_ptz.serve.site.pairs import HealthState
from scope_ptz.serve.site.presets import KnownPreset
from scope_ptz.store.feedback import MAX_COMMENT_CHARS
from scope_ptz.store.rows import FeedbackRow, FrameRow, RunKind, RunRow, StepRow

Finite = Annotated[float, Field(allow_inf_nan=False, ge=-1e6, le=1e6)]
Unit = Annotated[float, Field(allow_inf_nan=False, ge=0.0, le=1.0)]
Zoom = Annotated[float, Field(allow_inf_nan=False, gt=0.0, le=1e9)]
Instruction = Annotated[str, Field(min_length=1, max_length=MAX_INSTRUCTION_CHARS)]
Identifier = Annotated[str, Field(min_length=1, max_length=120)]


def _check_query_time(value: object) -> object:
    """Reject strings that are not a date and a time. Pydantic would parse a plain number as seconds since 1970."""
    if isinstance(value, str) and not re.match(r"\d{4}-\d\d-\d\d[Tt ]\d\d:\d\d", value):
        raise ValueError("expected a date and a time, such as 2026-05-01T14:30:00Z")
    return value


def whole_number(value: object) -> object:
    """Convert a number such as 2.0 to an integer; JSON does not distinguish the two."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


QueryTime = Annotated[datetime, BeforeValidator(_check_query_time)]
"""A date and time in a request's query."""


class Body(BaseModel):
    """Base class for request bodies. Wrong types and unknown fields are errors."""

    model_config = ConfigDict(extra="forbid", strict=True)


class Problem(BaseModel):
    """Why a request failed. ``code`` is for programs, and ``message`` is for people."""

    code: str
    message: str


class ErrorReply(BaseModel):
    """The reply to a request that failed."""

    error: Problem


class PoseModel(BaseModel):
    """A pose: pan and tilt in degrees, positive to the right and up, and magnification."""

    model_config = ConfigDict(extra="forbid", strict=True)

    pan_deg: Finite
    tilt_deg: Finite
    zoom: Zoom

    @classmethod
    def of(cls, pose: Pose) -> PoseModel:
        """Create the model for a pose."""
        return cls(pan_deg=float(pose.pan_deg), tilt_deg=float(pose.tilt_deg), zoom=float(pose.zoom))

    def pose(self) -> Pose:
        """Return the pose."""
        return Pose(self.pan_deg, self.tilt_deg, self.zoom)


class ArrivalModel(BaseModel):
    """The result of a move.

    ``pose`` is the pose at which the camera arrived. ``clamped`` names the axes that were stopped by one of the device's limits.
    ``limited_by`` describes any other limit that stopped the camera; empty if there was none.
    """

    pose: PoseModel
    clamped: list[str]
    limited_by: str

    @classmethod
    def of(cls, arrival: Arrival) -> ArrivalModel:
        """Create the model for an arrival."""
        return cls(pose=PoseModel.of(arrival.pose), clamped=list(arrival.clamped), limited_by=arrival.limited_by)


class Move(Body):
    """The absolute pose to go to. Omitted axes do not move."""

    pan_deg: Finite | None = None
    tilt_deg: Finite | None = None
    zoom: Zoom | None = None


class Centre(Body):
    """The point in a picture to centre, as fractions of the picture's width and height from the top left.

    ``pose`` is the pose of the picture that was clicked; by default, the current pose.
    """

    x: Unit
    y: Unit
    pose: PoseModel | None = None


class ZoomToBox(Body):
    """The box in a picture that should fill the view, as fractions of the picture's width and height from the top left.

    ``pose`` is the pose of the picture; by default, the current pose.
    """

    x_min: Unit
    y_min: Unit
    x_max: Unit
    y_max: Unit
    pose: PoseModel | None = None


class Drive(Body):
    """Velocities in degrees per second and, for the zoom, in octaves of magnification per second.

    The camera stops after ``timeout_s`` seconds.
    """

    pan_dps: Finite = 0.0
    tilt_dps: Finite = 0.0
    zoom_rate: Finite = 0.0
    timeout_s: Annotated[float, Field(gt=0.0, le=MAX_DRIVE_TIMEOUT_S, allow_inf_nan=False)] = 0.5


class PresetModel(BaseModel):
    """A preset.

    ``pose`` and ``viewpoint`` are null if they are not known yet; ``viewpoint`` is also null for a camera that is not simulated.
    ``has_picture`` is true if there is a thumbnail.
    """

    name: str
    description: str
    pose: PoseModel | None = None
    viewpoint: str | None = None
    has_picture: bool = False

    @classmethod
    def of(cls, known: KnownPreset) -> PresetModel:
        """Create the model for a preset."""
        preset, position = known.preset, known.position
        return cls(
            name=preset.name,
            description=preset.description,
            pose=None if position is None else PoseModel.of(position.pose),
            viewpoint=None if position is None else position.viewpoint,
            has_picture=known.has_picture,
        )


class PresetText(Body):
    """The description of a new preset."""

    description: Annotated[str, Field(max_length=200)] = ""


class PresetName(Body):
    """The new name of a preset."""

    name: Annotated[str, Field(min_length=1, max_length=31)]


class ControlRequestModel(BaseModel):
    """A request for control. ``client`` is the key to pass in the answer, and ``name`` is the name of the client that is asking."""

    client: str
    name: str
    since: datetime


class ControlModel(BaseModel):
    """Which client controls a camera, and which clients are asking for control.

    ``holder`` is the name of the client that has had control since ``since``; both are null if nobody has control. ``mine`` is true
    if the client that sent this request has control.
    """

    holder: str | None
    since: datetime | None
    mine: bool
    requests: list[ControlRequestModel]


class ControlAnswer(Body):
    """The controlling client's answer to a client that is asking for control. ``grant`` hands control over."""

    client: Annotated[str, Field(min_length=1, max_length=200)]
    grant: bool


class LimitsModel(BaseModel):
    """The limits on a camera's pose. If ``pan_endless`` is true, the camera can pan continuously through 360 degrees."""

    min_pan_deg: float
    max_pan_deg: float
    min_tilt_deg: float
    max_tilt_deg: float
    min_zoom: float
    max_zoom: float
    pan_endless: bool


class SpeedModel(BaseModel):
    """A camera's top speed, in the same units as ``Drive``. An axis with a top speed of 0 cannot be driven."""

    pan_dps: float
    tilt_dps: float
    zoom_rate: float


class CameraSummary(BaseModel):
    """One of the site's cameras.

    ``open`` is true if the camera has been opened since the server started. ``run`` is the id of the run in progress, and
    ``holder`` is the name of the client that has control; each is null if there is none.
    """

    name: str
    open: bool
    run: str | None
    holder: str | None


class RegionModel(BaseModel):
    """A keep-out region, at which the camera is never aimed, with a minimum and a maximum for pan and for tilt."""

    name: str
    pan_deg: tuple[float, float]
    tilt_deg: tuple[float, float]


class CameraState(BaseModel):
    """A camera's state.

    ``run`` is the id of the run in progress; null if there is none. ``edits_presets`` is true if presets can be saved and removed.
    ``fields_of_view`` lists magnifications with their horizontal field of view in degrees. ``assumed`` lists the values that the
    driver assumes because they have not been measured.
    """

    name: str
    title: str
    simulated: bool
    scene: str | None
    viewpoint: str | None
    frame_width: int
    frame_height: int
    pose: PoseModel
    hfov_deg: float
    time_s: float
    limits: LimitsModel
    top_speed: SpeedModel
    edits_presets: bool
    fields_of_view: list[tuple[float, float]]
    presets: list[PresetModel]
    keep_out: list[RegionModel]
    run: str | None
    can_undo: bool
    control: ControlModel
    assumed: list[str]


class RunStart(Body):
    """A run to start.

    Attributes:
        camera: The name of the camera.
        instruction: The instruction in plain language.
        conversation: The id of the conversation that the run continues; by default, none.
        pair: The pair of models; by default, the conversation's pair, or else the site's default.
        dry_run: Whether to report moves without carrying them out. Pictures are taken in any case.
    """

    camera: Identifier
    instruction: Instruction
    conversation: Identifier | None = None
    pair: Identifier | None = None
    dry_run: bool = False


class RunState(BaseModel):
    """A run's state.

    ``actor`` is the name of the client that started the run. ``events`` is the number of records so far. ``preview`` lists the
    commands that a dry run did not send to the camera.
    """

    id: str
    camera: str
    kind: RunKind
    instruction: str
    conversation: str | None
    actor: str
    running: bool
    outcome: str
    answer: str
    events: int
    preview: list[str]


class RunDetails(BaseModel):
    """The stored data for a run: its summary, calls, pictures and feedback."""

    run: RunRow
    steps: list[StepRow]
    frames: list[FrameRow]
    feedback: list[FeedbackRow]


class RunList(BaseModel):
    """A page of runs, newest first.

    ``next`` is the cursor for the next page; null on the last page. ``count`` is the number of runs that match the filters; if
    ``count_is_limit`` is true, there may be more.
    """

    runs: list[RunRow]
    next: str | None
    count: int
    count_is_limit: bool


class Mark(BaseModel):
    """A detection in a picture: a numbered box, as fractions of the frame's width and height."""

    number: int
    box: dict[str, float | str | None]


class PictureModel(BaseModel):
    """A picture from a run.

    ``position`` (counted from 0), ``tool`` and ``message`` describe the call to which the picture belongs. For the picture from the
    start of the run, ``position`` and ``tool`` are null. ``marks`` are the detections in the picture.
    """

    name: str
    position: int | None
    tool: str | None
    message: str
    marks: list[Mark]


class ToolReply(BaseModel):
    """The outcome of a tool call.

    Either ``result`` or ``error`` is set. ``fault`` names the component that failed, if one did, and ``code`` is the error
    code, for example ``kept_out``. ``run`` is the id under which the call is stored, and ``pose`` is the camera's pose after the
    call.
    """

    run: str
    result: dict[str, Any] | None
    error: str | None
    fault: str | None
    code: str | None
    pose: PoseModel


class FeedbackBody(Body):
    """Feedback on a run or, if ``position`` (counted from 0) is set, on one of its calls.

    A rating is 1 for good, -1 for bad, or 0 for a comment without a rating.
    """

    rating: Literal[-1, 0, 1]
    comment: Annotated[str, Field(max_length=MAX_COMMENT_CHARS)] = ""
    position: Annotated[int, Field(ge=0, le=100_000), BeforeValidator(whole_number)] | None = None


class KeepRequest(Body):
    """Whether to keep a run when old runs are removed."""

    kept: bool


class ConversationStart(Body):
    """The conversation to start. ``pair`` is the pair of models; by default, the site's default."""

    camera: Identifier
    pair: Identifier | None = None
    title: Annotated[str, Field(max_length=120)] = ""


class ConversationChange(Body):
    """A change to a conversation. Omitted fields stay the same."""

    title: Annotated[str, Field(max_length=120)] | None = None
    pair: Identifier | None = None


class SignIn(Body):
    """The token to sign in with."""

    token: Annotated[str, Field(min_length=1, max_length=200)]


class ClientInfo(BaseModel):
    """The client that sent the request.

    ``client`` is the client's key, as in ``ControlRequestModel``. ``signs_in`` is true if the server requires sign-in with a token.
    """

    name: str
    role: Role
    client: str
    signs_in: bool


class ModelHealth(BaseModel):
    """The name of a model and whether it can be used."""

    name: str
    state: HealthState


class PairHealth(BaseModel):
    """Whether the models of a pair can be used."""

    pair: str
    planner: ModelHealth
    perception: ModelHealth


class ServerInfo(BaseModel):
    """The server's name and version, and the names of its cameras and pairs of models."""

    name: str
    version: str
    cameras: list[str]
    pairs: list[str]
