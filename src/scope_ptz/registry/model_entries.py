"""The registry's entries: models, servers and pairs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import AnyHttpUrl, BaseModel, ConfigDict, Field, model_validator

Name = Annotated[str, Field(min_length=1, max_length=80, pattern=r"^[a-z0-9][a-z0-9._-]*$")]
Role = Literal["planner", "perception"]
Precision = Literal["fp16", "bf16", "fp8", "mxfp4", "int4", "q4", "fp32"]
Thinking = Literal["none", "optional", "default", "always"]
"""When a model reasons: "none" (never), "optional" (on request), "default" (unless switched off) or "always".

If a model always reasons, only the length of the reasoning can be set.
"""
BYTES_PER_PARAMETER: dict[Precision, float] = {
    "fp32": 4.0, "fp16": 2.0, "bf16": 2.0, "fp8": 1.05, "int4": 0.6, "q4": 0.61, "mxfp4": 0.61,
}  # fmt: skip
"""Memory for the weights, in bytes per parameter.

Four-bit formats need more than 0.5 bytes, because they also store scales, and some layers with more bits (Q4_K_M: 4.85 bits per
weight).
"""
RUNTIME_GB = 1.5
"""Memory in GB that a server needs besides weights and key-value cache: kernels, activations and the vision tower's workspace."""
WINDOW = 16_384
"""Context length in tokens for memory figures and serve commands. A long agent run needs about half of it."""


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Server(_Entry):
    """A server program, such as vLLM or Ollama.

    Attributes:
        command: The commands for serving a model, in order, with the placeholders ``{source}``, ``{window}`` and ``{flags}``.
    """

    title: str
    command: tuple[str, ...]
    url: str = Field(description="The server's default address; empty if models run inside SCOPE.")
    install: str = ""
    notes: str = ""


class Serving(_Entry):
    """How a server program serves a model. ``command`` overrides the command in the server entry."""

    source: str = Field(default="", description="The model's name on the server; empty means the model's repository.")
    precision: Precision | None = None
    flags: str = ""
    command: tuple[str, ...] = ()
    notes: str = ""


class Model(_Entry):
    """A model for planning, for perception, or for both.

    Attributes:
        size_b: Number of parameters in billions, as stated by the model's authors.
        active_b: Number of parameters that are active per token, in billions, as stated by the model's authors.
        parameters_b: Number of parameters in memory, in billions, including vision tower and embeddings; None if equal to
            ``size_b``.
        kv_kib: Size of the key-value cache per token of context, in KiB.
    """

    name: Name
    title: str
    repo: str
    revision: str | None = None
    roles: tuple[Role, ...] = Field(min_length=1)
    origin: Literal["paper", "current", "yours"] = "yours"
    family: str = ""
    backend: str = Field(default="", description="The perception backend, for models that can be used for perception.")
    size_b: float = Field(gt=0)
    active_b: float = Field(gt=0)
    parameters_b: float | None = Field(default=None, gt=0)
    precision: Precision
    context: int = Field(ge=0, description="Context length in tokens; 0 if the model has none.")
    thinking: Thinking = "none"
    sees: bool = Field(default=False, description="Whether the model accepts images in the chat.")
    coordinates: str = Field(default="none", description="Notation of boxes and points, see perception.models.coordinates.")
    licence: str
    kv_kib: float = Field(default=128.0, ge=0)
    memory_gb: float | None = Field(default=None, gt=0, description="Measured memory, which replaces the computed figure.")
    url: str = ""
    key_file: Path | None = None
    serve: dict[str, Serving] = Field(default_factory=dict)
    notes: str = ""
    source: str = Field(default="", description="Source of these facts.")

    @model_validator(mode="after")
    def _check_consistency(self) -> Model:
        if "perception" in self.roles and not self.backend:
            raise ValueError("a perception model needs a backend, for example 'moondream' or 'openai_vision'")
        if self.active_b > self.size_b:
            raise ValueError("active_b cannot exceed size_b")
        if self.url:
            AnyHttpUrl(self.url)
        return self

    def memory_for(self, server: str | None = None) -> float:
        """Return the memory in GB (10^9 bytes) for serving the model with a context of ``WINDOW`` tokens.

        This is parameters x bytes per parameter + key-value cache + ``RUNTIME_GB``, unless a measured ``memory_gb`` is available
        for the server's precision.
        """
        serving = self.serve.get(server) if server else None
        precision = (serving.precision if serving else None) or self.precision
        if self.memory_gb is not None and precision == self.precision:
            return self.memory_gb
        weights = (self.parameters_b or self.size_b) * BYTES_PER_PARAMETER[precision]
        cache = self.kv_kib * 1024 * self.window / 1e9
        return round(weights + cache + RUNTIME_GB, 1)

    @property
    def window(self) -> int:
        """Context length in tokens with which to serve the model."""
        return min(self.context, WINDOW)

    def min_memory_server(self) -> tuple[str | None, float]:
        """Return the server on which the model needs the least memory, and the memory in GB. Ties go to the first server."""
        if not self.serve:
            return None, self.memory_for()
        server = min(self.serve, key=self.memory_for)
        return server, self.memory_for(server)

    def served_names(self) -> tuple[str, ...]:
        """Return the names that a server may use for the model, most likely first."""
        return tuple(dict.fromkeys([self.repo, *(s.source for s in self.serve.values() if s.source), self.title, self.name]))


class Pair(_Entry):
    """A planner and a perception model, by name. ``paper_average`` is the paper's macro accuracy in percent."""

    name: str
    planner: str
    perception: str
    origin: Literal["paper", "current", "yours"] = "yours"
    paper_average: float | None = None
