"""The description from which a backend is made."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.errors import ConfigError


class BackendSpec(BaseModel):
    """A perception backend to make.

    Attributes:
        name: The source that results name.
        backend: A module of this package, or the name of another package's backend.
        model: The model's name on its server or on the hub.
        coordinates: A convention of ``perception.models.coordinates``.
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
        """Return the endpoint, for backends that use a server.

        Raises:
            ConfigError: There is no endpoint.
        """
        if self.endpoint is None:
            raise ConfigError(f"The perception backend '{self.name}' needs a model server. Give its address with --perception-url.")
        return self.endpoint

    def needed_model(self) -> str:
        """Return the model, for backends that load one.

        Raises:
            ConfigError: There is no model.
        """
        if not self.model:
            raise ConfigError(f"The perception backend '{self.name}' needs the name or the folder of a model.")
        return self.model


_Options = TypeVar("_Options", bound="Options")


class Options(BaseModel):
    """Base class of a backend's options. Unknown and wrong options are user errors."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @classmethod
    def of(cls: type[_Options], spec: BackendSpec) -> _Options:
        """Return the validated options of a spec.

        Raises:
            ConfigError: An option is unknown or wrong.
        """
        try:
            return cls.model_validate(spec.options)
        except ValidationError as error:
            first = error.errors(include_input=False)[0]
            where = ".".join(str(p) for p in first["loc"])
            raise ConfigError(f"The option '{where}' of the perception backend '{spec.name}' is wrong: {first['msg']}.") from None


def need(extra: str, *packages: str) -> None:
    """Check that all packages of an extra are installed, without importing them.

    Raises:
        ConfigError: A package is missing.
    """
    missing = [package for package in packages if find_spec(package) is None]
    if missing:
        raise ConfigError(f"This needs {' and '.join(missing)}. Install with: pip install 'scope-ptz[{extra}]'")
