"""What the registry knows of a model, a server and a pair."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import AnyHttpUrl, BaseModel, ConfigDict, Field, model_validator

Name = Annotated[str, Field(min_length=1, max_length=80, pattern=r"^[a-z0-9][a-z0-9._-]*$")]
Role = Literal["planner", "perception"]
Precision = Literal["fp16", "bf16", "fp8", "mxfp4", "int4", "q4", "fp32"]
Thinking = Literal["none", "optional", "default", "always"]
"""``none``: never; ``optional``: only when asked to; ``default``: unless told not to; ``always``: only how much can be set."""
BYTES_PER_PARAMETER: dict[Precision, float] = {
    "fp32": 4.0, "fp16": 2.0, "bf16": 2.0, "fp8": 1.05, "int4": 0.6, "q4": 0.61, "mxfp4": 0.61,
}  # fmt: skip
"""Weights in memory. Four-bit formats keep scales and some layers in more bits (Q4_K_M: 4.85 bits a weight)."""
RUNTIME_GB = 1.5
"""What a serving process takes beside weights and cache: kernels, activations, the vision tower's workspace."""
WINDOW = 16_384
"""Tokens of context that memory figures and serve commands allow for: a long run of the agent needs about half of it."""


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Server(_Entry):
    """A program that serves models. ``command``: one line a command, with ``{source}``, ``{window}`` and ``{flags}`` to fill in."""

    title: str
    command: tuple[str, ...]
    url: str = Field(description="Where it listens unless told otherwise; empty for what runs inside SCOPE.")
    install: str = ""
    notes: str = ""


class Serving(_Entry):
    """How one server runs one model. ``command`` replaces the server's own."""

    source: str = Field(default="", description="What the server calls the model; empty: the model's repository.")
    precision: Precision | None = None
    flags: str = ""
    command: tuple[str, ...] = ()
    notes: str = ""


class Model(_Entry):
    """A planner, a pair of eyes, or both.

    ``size_b`` and ``active_b`` are billions of parameters as the model's makers give them; ``parameters_b`` is what is really
    loaded (vision tower and embeddings included) where that differs. ``kv_kib``: cache for a token of context, in KiB.
    """

    name: Name
    title: str
    repo: str
    revision: str | None = None
    roles: tuple[Role, ...] = Field(min_length=1)
    origin: Literal["paper", "current", "yours"] = "yours"
    family: str = ""
    backend: str = Field(default="", description="The perception backend, for eyes.")
    size_b: float = Field(gt=0)
    active_b: float = Field(gt=0)
    parameters_b: float | None = Field(default=None, gt=0)
    precision: Precision
    context: int = Field(ge=0, description="Tokens; 0 where the notion does not apply.")
    thinking: Thinking = "none"
    sees: bool = Field(default=False, description="Takes images in the chat, so that it can be planner and eyes at once.")
    coordinates: str = Field(default="none", description="How it writes boxes and points: a convention of perception.coordinates.")
    licence: str
    kv_kib: float = Field(default=128.0, ge=0)
    memory_gb: float | None = Field(default=None, gt=0, description="A known figure instead of the computed one.")
    url: str = ""
    key_file: Path | None = None
    serve: dict[str, Serving] = Field(default_factory=dict)
    notes: str = ""
    source: str = Field(default="", description="Where these facts stand.")

    @model_validator(mode="after")
    def _consistent(self) -> Model:
        if "perception" in self.roles and not self.backend:
            raise ValueError("eyes need a backend, for example 'moondream' or 'openai_vision'")
        if self.active_b > self.size_b:
            raise ValueError("active_b cannot exceed size_b")
        if self.url:
            AnyHttpUrl(self.url)
        return self

    def memory_for(self, server: str | None = None) -> float:
        """GB (10^9 bytes) to serve it with a window of ``WINDOW`` tokens: parameters x bytes + cache + ``RUNTIME_GB``. Computed,
        not measured, unless ``memory_gb`` is given."""
        serving = self.serve.get(server) if server else None
        precision = (serving.precision if serving else None) or self.precision
        if self.memory_gb is not None and precision == self.precision:
            return self.memory_gb
        weights = (self.parameters_b or self.size_b) * BYTES_PER_PARAMETER[precision]
        cache = self.kv_kib * 1024 * self.window / 1e9
        return round(weights + cache + RUNTIME_GB, 1)

    @property
    def window(self) -> int:
        """Tokens of context to serve it with."""
        return min(self.context, WINDOW)

    def smallest(self) -> tuple[str | None, float]:
        """The server that needs least memory, and how much; of equals the first."""
        if not self.serve:
            return None, self.memory_for()
        server = min(self.serve, key=self.memory_for)
        return server, self.memory_for(server)

    def served_names(self) -> tuple[str, ...]:
        """What a server may call this model, the most likely first."""
        return tuple(dict.fromkeys([self.repo, *(s.source for s in self.serve.values() if s.source), self.title, self.name]))


class Pair(_Entry):
    """A planner and eyes, by the names of their models. ``paper_average``: macro accuracy in %, as the paper gives it."""

    name: str
    planner: str
    perception: str
    origin: Literal["paper", "current", "yours"] = "yours"
    paper_average: float | None = None
