"""Perception backend specs, and the base class for backend options."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.errors import ConfigError


class BackendSpec(BaseModel):
    """The spec of a perception backend.

    Attributes:
        name: The backend's name, which results report as their source.
        backend: The backend type: the name of a module in this package or of a plug-in.
        model: The model's name on its server or on Hugging Face.
        endpoint: The model server; None for backends that run in this process.
        coordinates: The name of a convention in ``perception.models.coordinates``.
        options: The backend's own options.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    backend: str
    model: str = ""
    endpoint: Endpoint | None = None
    coordinates: str = "generic"
    options: dict[str, Any] = Field(default_factory=dict)

    def needed_endpoint(self) -> Endpoint:
        """Return the endpoint, for a backend that requires a server.

        Raises:
            ConfigError: The spec has no endpoint.
        """
        if self.endpoint is None:
            raise ConfigError(f"The perception backend '{self.name}' needs a model server. Give its address with --perception-url.")
        return self.endpoint

    def needed_model(self) -> str:
        """Return the model's name, for a backend that loads a model.

        Raises:
            ConfigError: The spec has no model.
        """
        if not self.model:
            raise ConfigError(f"The perception backend '{self.name}' needs a model. Give the model's name or its folder.")
        return self.model


_Options = TypeVar("_Options", bound="Options")


class Options(BaseModel):
    """Base class for backend options. Unknown and invalid options raise ``ConfigError``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @classmethod
    def of(cls: type[_Options], spec: BackendSpec) -> _Options:
        """Return a spec's validated options.

        Raises:
            ConfigError: An option is unknown or invalid.
        """
        try:
            return cls.model_validate(spec.options)
        except ValidationError as error:
            first = error.errors(include_input=False)[0]
            where = ".".join(str(p) for p in first["loc"])
            raise ConfigError(f"The option '{where}' of the perception backend '{spec.name}' is invalid: {first['msg']}.") from None


def require_packages(extra: str, *packages: str) -> None:
    """Check that the packages of an optional extra are installed, without importing them.

    Raises:
        ConfigError: A package is missing.
    """
    missing = [package for package in packages if find_spec(package) is None]
    if missing:
        raise ConfigError(f"This feature needs {' and '.join(missing)}. Install with: pip install 'scope-ptz[{extra}]'")
