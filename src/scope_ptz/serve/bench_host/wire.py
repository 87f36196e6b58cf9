"""The messages between the host and a worker: JSON lines over the worker's standard input and output."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from scope_ptz.bench.agents.messages import HostMessage

MAX_LINE_BYTES = 64 * 1024 * 1024
"""Maximum size of a line in bytes. A simulated camera's frame takes less than 1 MB."""


class _WireModel(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class PerceptionSettings(_WireModel):
    """The perception that the host provides to all participants. It has the same fields as ``factory.models.ModelOptions``."""

    perception: str | None = None
    perception_url: str | None = None
    perception_model: str | None = None
    perception_key_file: Path | None = None
    perception_options: tuple[str, ...] = ()


class EvaluationSettings(_WireModel):
    """Settings for hosted evaluations. All evaluations in a host's folder have the same settings.

    Attributes:
        tasks: Split or task file.
        perception: The perception that the host provides.
        epochs: Number of runs per task.
        seed: The evaluation's seed, for example for noisy perception.
        max_steps: Maximum number of steps in a run.
        step_s: Maximum time that an agent may take for one step, in seconds.
        task_s: Maximum time that an agent may take for all steps of a task, in seconds.
    """

    tasks: str
    perception: PerceptionSettings = PerceptionSettings()
    epochs: Annotated[int, Field(ge=1)] = 1
    seed: int = 1
    max_steps: Annotated[int, Field(ge=1)] = 60
    step_s: Annotated[float, Field(gt=0)] = 300.0
    task_s: Annotated[float, Field(gt=0)] = 1800.0


class WorkerSettings(_WireModel):
    """The first line that a worker receives.

    Attributes:
        evaluation: The evaluation settings.
        participant: Name of the participant.
        folder: Folder for the log, the submission and its signature.
        key: Private key file for signing the submission.
        order_seed: Secret seed for the participant's task order.
        check_only: Whether to check the settings, report the number of runs, and end.
    """

    evaluation: EvaluationSettings
    participant: str
    folder: Path
    key: Path
    order_seed: str = Field(repr=False)
    check_only: bool = False


class Begin(_WireModel):
    """A command to begin the offered run."""

    type: Literal["begin"] = "begin"
    run: str


class Deliver(_WireModel):
    """A message from the agent, as sent. ``run`` is the key of the run that the message belongs to."""

    type: Literal["deliver"] = "deliver"
    run: str
    line: str = Field(repr=False)


class AgentGone(_WireModel):
    """The agent will send no more messages in this run."""

    type: Literal["gone"] = "gone"
    run: str
    reason: str


class Ready(_WireModel):
    """The worker has loaded its tasks. ``runs`` is the number of runs in the evaluation."""

    type: Literal["ready"] = "ready"
    runs: int


class RunOffered(_WireModel):
    """A run is waiting for its agent. ``run`` is an opaque key that stays the same after a restart."""

    type: Literal["offered"] = "offered"
    run: str


class MessageToAgent(_WireModel):
    """A message for the agent."""

    type: Literal["sent"] = "sent"
    run: str
    message: Annotated[HostMessage, Field(discriminator="type")]


class RunEnded(_WireModel):
    """The agent's part in a run has ended."""

    type: Literal["over"] = "over"
    run: str
    reason: str


class Finished(_WireModel):
    """Every run has ended. ``submission`` is the path of the signed submission."""

    type: Literal["finished"] = "finished"
    submission: Path


class Failed(_WireModel):
    """The worker cannot continue. The message is for the operator only."""

    type: Literal["failed"] = "failed"
    message: str


Command = Begin | Deliver | AgentGone
"""A message from the host to a worker."""
Event = Ready | RunOffered | MessageToAgent | RunEnded | Finished | Failed
"""A message from a worker to the host."""

COMMAND: TypeAdapter[Command] = TypeAdapter(Annotated[Command, Field(discriminator="type")])
EVENT: TypeAdapter[Event] = TypeAdapter(Annotated[Event, Field(discriminator="type")])
