"""Load the model registry, which consists of packaged and user-defined entries."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from scope_ptz.errors import ConfigError, UnknownNameError
from scope_ptz.registry.model_entries import Model, Pair, Role, Server

PACKAGED_FILE = "models.yaml"


class _ModelsFile(BaseModel):
    """The content of a models file. The keys in ``servers`` and ``models`` are the names of the entries."""

    model_config = ConfigDict(extra="forbid")

    servers: dict[str, dict[str, Any]] = {}
    models: dict[str, dict[str, Any]] = {}
    pairs: list[dict[str, Any]] = []


class Registry:
    """Models, servers and pairs by name."""

    def __init__(self, servers: Mapping[str, Server], models: Mapping[str, Model], pairs: Mapping[str, Pair]) -> None:
        self.servers, self.models, self.pairs = dict(servers), dict(models), dict(pairs)

    def model(self, name: str, role: Role | None = None) -> Model:
        """Return a model by name, title or repository, ignoring case.

        Raises:
            UnknownNameError: There is no such model.
            ConfigError: The model does not support the role.
        """
        key = name.strip().lower()
        model = self.models.get(key) or next((m for m in self.models.values() if key in _names(m)), None)
        if model is None:
            raise UnknownNameError(role or "model", name, self.model_names(role))
        if role is not None and role not in model.roles:
            ability = "plan" if role == "planner" else "be used for perception"
            raise ConfigError(f"{model.name} cannot {ability}. Models that can: {', '.join(self.model_names(role))}.")
        return model

    def model_names(self, role: Role | None = None) -> list[str]:
        """Return the names of the models that support a role, or of all models if ``role`` is None."""
        return [m.name for m in self.models.values() if role is None or role in m.roles]

    def pair(self, text: str) -> Pair:
        """Return a pair by name: a registered pair, ``PLANNER+PERCEPTION``, or a model that supports both roles.

        Raises:
            UnknownNameError: There is no such model.
            ConfigError: A model does not support its role.
        """
        if text in self.pairs:
            return self.pairs[text]
        planner, plus, perception = text.partition("+")
        if plus:
            planner, perception = self.model(planner, "planner").name, self.model(perception, "perception").name
            name = f"{planner}+{perception}"
            return self.pairs.get(name) or Pair(name=name, planner=planner, perception=perception)
        model = self.model(text)
        if set(model.roles) != {"planner", "perception"}:
            raise ConfigError(
                f"{model.name} is only a {model.roles[0]} model. Give PLANNER+PERCEPTION; `scope models pairs` lists the pairs."
            )
        return Pair(name=model.name, planner=model.name, perception=model.name)

    def server(self, name: str) -> Server:
        """Return a server by name.

        Raises:
            UnknownNameError: There is no such server.
        """
        if name not in self.servers:
            raise UnknownNameError("server", name, self.servers)
        return self.servers[name]

    def commands(self, model: Model, server: str) -> tuple[str, ...]:
        """Return the commands for serving a model on a server, with all placeholders replaced.

        Raises:
            ConfigError: The server cannot run the model.
        """
        program = self.server(server)
        if server not in model.serve:
            supported = ", ".join(model.serve) or "none"
            raise ConfigError(f"{model.name} cannot be served with {server}. Servers that can: {supported}.")
        serving = model.serve[server]
        values = {"source": serving.source or model.repo, "window": str(model.window), "flags": serving.flags}
        return tuple(_fill_placeholders(line, values) for line in serving.command or program.command)


def load_registry(user_file: Path | None = None) -> Registry:
    """Load the packaged registry, and add the user's entries. A user's entry replaces a packaged entry with the same name.

    Raises:
        ConfigError: The user's file is unreadable or invalid. The message names the file and the field.
    """
    servers, models, pairs = _packaged_entries()
    if user_file is not None:
        try:
            user_text = user_file.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise ConfigError(f"The models file {user_file} cannot be read: {error}.") from error
        user_servers, user_models, user_pairs = _parse(user_text, str(user_file))
        servers, models, pairs = {**servers, **user_servers}, {**models, **user_models}, {**pairs, **user_pairs}
        _check_references(Registry(servers, models, pairs), user_file)
    return Registry(servers, models, pairs)


@cache
def _packaged_entries() -> tuple[Mapping[str, Server], Mapping[str, Model], Mapping[str, Pair]]:
    """Return the packaged entries, which are parsed once per process."""
    return _parse(files("scope_ptz").joinpath("data", PACKAGED_FILE).read_text(encoding="utf-8"), PACKAGED_FILE)


def _parse(text: str, source: str) -> tuple[dict[str, Server], dict[str, Model], dict[str, Pair]]:
    import yaml

    try:
        content = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506 - both are safe loaders
    except yaml.YAMLError as error:
        raise ConfigError(f"{source} is not valid YAML: {' '.join(str(error).split())}.") from error
    location: tuple[str | int, ...] = ()
    try:
        file = _ModelsFile.model_validate(content or {})
        servers, models, pairs = {}, {}, {}
        for name, entry in file.servers.items():
            location = ("servers", name)
            servers[name] = Server.model_validate(entry)
        for name, entry in file.models.items():
            location = ("models", name)
            models[name] = Model.model_validate({**entry, "name": name, "title": entry.get("title", name)})
        for index, entry in enumerate(file.pairs):
            location = ("pairs", index)
            pair = Pair.model_validate({"name": f"{entry.get('planner')}+{entry.get('perception')}", **entry})
            pairs[pair.name] = pair
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        path = ".".join(str(part) for part in (*location, *first["loc"]))
        raise ConfigError(f"{source}: {path}: {first['msg']}.") from error
    return servers, models, pairs


def _check_references(registry: Registry, source: Path) -> None:
    """Check that all servers and models that entries refer to exist."""
    for model in registry.models.values():
        for server in model.serve:
            if server not in registry.servers:
                raise ConfigError(
                    f"{source}: models.{model.name}.serve.{server}: there is no such server. "
                    f"Use one of {', '.join(registry.servers)}, or add it under servers."
                )
    for pair in registry.pairs.values():
        registry.model(pair.planner, "planner")
        registry.model(pair.perception, "perception")


def _fill_placeholders(line: str, values: Mapping[str, str]) -> str:
    """Replace the placeholders in a command. Other braces, such as those of JSON in a flag, remain unchanged."""
    for name, value in values.items():
        line = line.replace(f"{{{name}}}", value)
    return " ".join(line.split())


def _names(model: Model) -> set[str]:
    return {n.lower() for n in (model.name, model.title, model.repo)}
