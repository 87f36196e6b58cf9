"""What a backend is made from."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.errors import ConfigError


class BackendSpec(BaseModel):
    """``name``: what results call the eyes; ``backend``: a module of this package or a third party's name; ``model``: as its server
    or the hub calls it; ``coordinates``: a convention of ``perception.coordinates``; ``options``: what the backend's own model of
    options reads."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    backend: str
    model: str = ""
    endpoint: Endpoint | None = None
    coordinates: str = "generic"
    options: dict[str, Any] = Field(default_factory=dict)

    def needed_endpoint(self) -> Endpoint:
        """The endpoint, for backends that ask a server."""
        if self.endpoint is None:
            raise ConfigError(f"The eyes '{self.name}' ask a model server. Say where it is, with --perception-url.")
        return self.endpoint

    def needed_model(self) -> str:
        """The model, for backends that load one."""
        if not self.model:
            raise ConfigError(f"The eyes '{self.name}' need the name or the folder of a model.")
        return self.model


_Options = TypeVar("_Options", bound="Options")


class Options(BaseModel):
    """Base of a backend's options: unknown and wrong ones are errors of the user."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @classmethod
    def of(cls: type[_Options], spec: BackendSpec) -> _Options:
        try:
            return cls.model_validate(spec.options)
        except ValidationError as error:
            first = error.errors(include_input=False)[0]
            where = ".".join(str(p) for p in first["loc"])
            raise ConfigError(f"The option '{where}' of the eyes '{spec.name}' is wrong: {first['msg']}.") from None


def need(extra: str, *packages: str) -> None:
    """Raise ``ConfigError`` unless all packages of an extra are installed. Nothing is imported."""
    missing = [package for package in packages if find_spec(package) is None]
    if missing:
        raise ConfigError(f"This needs {' and '.join(missing)}. Install with: pip install 'scope-ptz[{extra}]'")
