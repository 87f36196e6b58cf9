"""From options to a planner and eyes: names of the registry, pairs, addresses, keys. Nothing is built here but descriptions."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scope_ptz.errors import ConfigError, InputError, UnknownNameError
from scope_ptz.factory.served_names import named, recognised
from scope_ptz.settings import ScopeSettings, load_settings

if TYPE_CHECKING:
    from pydantic import SecretStr

    from scope_ptz.endpoints.endpoint import Endpoint
    from scope_ptz.perception.backends.spec import BackendSpec
    from scope_ptz.planner.chat import ChatOptions
    from scope_ptz.registry import Model, Registry, Role

BUILT_IN_PERCEPTION = ("ground-truth", "noisy")
GRAMMAR, CHAT = "grammar", "chat"
CHAT_BACKEND = "openai_vision"
ASKING = ("moondream", CHAT_BACKEND)
"""Backends that cannot do without a server."""
SERVERLESS = ("ocr", "router", "transformers_local", "zero_shot")
"""Those that have no use for one. Other people's backends get an address when there is one."""


@dataclass(frozen=True, slots=True)
class ModelOptions:
    """Options about models and their servers, as they were typed."""

    planner: str | None = None
    perception: str | None = None
    pair: str | None = None
    planner_url: str | None = None
    perception_url: str | None = None
    planner_model: str | None = None
    perception_model: str | None = None
    planner_key_file: Path | None = None
    perception_key_file: Path | None = None
    planner_options: tuple[str, ...] = ()
    perception_options: tuple[str, ...] = ()
    reader: str | None = None
    detector: str | None = None
    timeout_s: float | None = None


@dataclass(frozen=True, slots=True)
class ResolvedPlanner:
    """``endpoint`` and ``options``: of a model; ``model``: what the registry knows of it."""

    name: str
    endpoint: Endpoint | None = None
    options: ChatOptions | None = None
    model: Model | None = None


@dataclass(frozen=True, slots=True)
class ResolvedPerception:
    """``spec``: of a model; ``model``: what the registry knows of it."""

    name: str
    spec: BackendSpec | None = None
    model: Model | None = None


@dataclass(frozen=True, slots=True)
class ResolvedPair:
    planner: ResolvedPlanner
    eyes: ResolvedPerception


async def resolve_models(wishes: ModelOptions) -> ResolvedPair:
    """Who plans and who sees. Asks servers for their lists of models, where it has to know their names for them.

    Raises ``InputError`` for names, addresses and combinations that cannot be.
    """
    if not _wants_models(wishes):
        return ResolvedPair(ResolvedPlanner(GRAMMAR), ResolvedPerception(wishes.perception or BUILT_IN_PERCEPTION[0]))
    return await _Resolver(wishes, load_settings()).resolve()


def _wants_models(wishes: ModelOptions) -> bool:
    plain = ModelOptions(planner=wishes.planner, perception=wishes.perception)
    return wishes != plain or wishes.planner not in (None, GRAMMAR) or wishes.perception not in (None, *BUILT_IN_PERCEPTION)


class _Resolver:
    def __init__(self, wishes: ModelOptions, settings: ScopeSettings) -> None:
        from scope_ptz.registry import load_registry

        self.wishes, self.settings = wishes, settings
        self.registry: Registry = load_registry(settings.models_file())

    async def resolve(self) -> ResolvedPair:
        w = self.wishes
        planner, eyes = w.planner, w.perception
        if w.pair is not None:
            if planner is not None or eyes is not None:
                raise InputError("Give --pair, or --planner and --perception, not both.")
            planner, eyes = read_pair(self.registry, w.pair)
        planner = planner or (CHAT if w.planner_url or w.planner_model else GRAMMAR)
        eyes = eyes or (CHAT_BACKEND if w.perception_url or w.perception_model else BUILT_IN_PERCEPTION[0])
        both = planner == eyes
        chosen = await self._planner(planner, sees=both)
        return ResolvedPair(chosen, self._composed(await self._eyes(eyes, chosen if both else None)))

    async def _planner(self, name: str, *, sees: bool) -> ResolvedPlanner:
        w = self.wishes
        if name == GRAMMAR:
            if w.planner_url or w.planner_model or w.planner_options or w.planner_key_file:
                raise InputError("The grammar planner has no server and no options. Leave --planner-... out, or name a model.")
            return ResolvedPlanner(GRAMMAR)
        model = self._known(name, "planner", w.planner_url) if name != CHAT else None
        given = w.planner_url or (model.url if model else "") or self.settings.planner_url
        key = self._key(w.planner_key_file, model, given, self.settings.planner_key)
        endpoint = self._endpoint(given, key, "planner", name, model)
        wanted = w.planner_model or (name if model is None and name != CHAT else None)
        endpoint = await named(endpoint, wanted, model, "--planner-model")
        model = model or recognised(self.registry, endpoint.model, "planner")
        return ResolvedPlanner(model.name if model else endpoint.model, endpoint, self._chat_options(model, sees=sees), model)

    def _chat_options(self, model: Model | None, *, sees: bool) -> ChatOptions:
        from pydantic import ValidationError

        from scope_ptz.planner.chat import ChatOptions

        given: dict[str, Any] = {}
        if model is not None:
            # A camera that is waited for has no time for long thoughts; --planner-option thinking=on asks for them.
            given = {"family": model.repo, "sees": sees and model.sees}
            given |= {"thinking": "off"} if model.thinking in ("default", "always") else {}
        given |= parse_options(self.wishes.planner_options, "--planner-option")
        try:
            return ChatOptions.model_validate(given)
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            where = ".".join(str(part) for part in first["loc"])
            raise ConfigError(f"--planner-option {where}: {first['msg']}. Known: {', '.join(ChatOptions.model_fields)}.") from None

    async def _eyes(self, name: str, same: ResolvedPlanner | None) -> ResolvedPerception:
        w = self.wishes
        if name in BUILT_IN_PERCEPTION:
            if w.perception_url or w.perception_model or w.perception_options or w.perception_key_file:
                raise InputError(f"The eyes '{name}' have no server and no options. Leave --perception-... out, or name a model.")
            return ResolvedPerception(name)
        if same is not None and same.endpoint is not None and not (w.perception_url or w.perception_model):
            return self._spec(name, same.model, same.endpoint)
        model = self._known_eyes(name)
        backend = self._backend(name, model)
        given = w.perception_url or (model.url if model else "") or ("" if backend in SERVERLESS else self.settings.perception_url)
        if not given and backend not in ASKING:
            return self._spec(name, model, None)
        key = self._key(w.perception_key_file, model, given, self.settings.perception_key)
        endpoint = self._endpoint(given, key, "perception", name, model)
        if backend == CHAT_BACKEND:
            endpoint = await named(endpoint, w.perception_model, model, "--perception-model")
            model = model or recognised(self.registry, endpoint.model, "perception")
        return self._spec(name, model, endpoint)

    def _spec(self, name: str, model: Model | None, endpoint: Endpoint | None) -> ResolvedPerception:
        from scope_ptz.perception.backends.spec import BackendSpec
        from scope_ptz.planner.chat.families import likely_server, switch_for

        options = dict(parse_options(self.wishes.perception_options, "--perception-option"))
        options.pop("backend", None)
        backend = self._backend(name, model)
        coordinates = options.pop("coordinates", None) or (model.coordinates if model else "generic")
        if backend == CHAT_BACKEND and endpoint is not None and "extra" not in options:
            quiet = switch_for(model.repo if model else endpoint.model, "off", likely_server(endpoint.url)).fields
            options |= {"extra": dict(quiet)} if quiet else {}
        served = self.wishes.perception_model or (endpoint.model if endpoint else "") or (model.repo if model else "")
        label = model.name if model else (served or name)
        spec = BackendSpec(name=label, backend=backend, model=served, endpoint=endpoint, coordinates=coordinates, options=options)
        return ResolvedPerception(label, spec, model)

    def _backend(self, name: str, model: Model | None) -> str:
        wanted = parse_options(self.wishes.perception_options, "--perception-option").get("backend")
        return str(wanted or (model.backend if model else name)).replace("-", "_")

    def _composed(self, eyes: ResolvedPerception) -> ResolvedPerception:
        """The eyes with a reader of text and a detector beside them, when these are wished for."""
        from scope_ptz.perception.backends.spec import BackendSpec

        w = self.wishes
        parts = {"reader": w.reader, "detector": w.detector}
        named = {role: self._spec_of_part(name) for role, name in parts.items() if name}
        if not named:
            return eyes
        if eyes.spec is None:
            raise InputError(f"--reader and --detector go with a model's eyes; '{eyes.name}' needs neither.")
        label = "+".join((eyes.name, *(part.name for part in named.values())))
        options = {"answerer": eyes.spec, **named}
        return ResolvedPerception(label, BackendSpec(name=label, backend="router", options=options), eyes.model)

    def _spec_of_part(self, name: str) -> BackendSpec:
        from scope_ptz.perception.backends.spec import BackendSpec

        model = self._known_eyes(name)
        if model is None:
            return BackendSpec(name=name, backend=name.replace("-", "_"))
        endpoint = (
            self._endpoint(model.url, self._key(None, model, model.url, None), "perception", name, model) if model.url else None
        )
        return BackendSpec(
            name=model.name, backend=model.backend, model=model.repo, endpoint=endpoint, coordinates=model.coordinates
        )

    def _known(self, name: str, role: Role, url: str | None) -> Model | None:
        """The registry's entry. A name that is not in it is taken as the server's own when there is a server to ask."""
        try:
            return self.registry.model(name, role)
        except UnknownNameError as error:
            if url:
                return None
            raise UnknownNameError(role, name, [GRAMMAR, CHAT, *self.registry.named(role)]) from error

    def _known_eyes(self, name: str) -> Model | None:
        from scope_ptz.perception.backends import backend_names

        if name.replace("-", "_") in backend_names():
            return None
        try:
            return self.registry.model(name, "perception")
        except UnknownNameError as error:
            raise UnknownNameError(
                "perception", name, [*BUILT_IN_PERCEPTION, *self.registry.named("perception"), *backend_names()]
            ) from error

    def _endpoint(self, url: str, key: SecretStr | None, role: str, name: str, model: Model | None) -> Endpoint:
        from scope_ptz.endpoints.endpoint import Endpoint, Timeouts

        if not url:
            how = f" `scope models serve-command {model.name}` says how to start one." if model else ""
            raise ConfigError(f"'{name}' runs on a model server. Say where it is, with --{role}-url.{how}")
        total = self.wishes.timeout_s
        return Endpoint(url=url, key=key, timeouts=Timeouts() if total is None else Timeouts.within(total))

    @staticmethod
    def _key(file: Path | None, model: Model | None, url: str, from_environment: SecretStr | None) -> SecretStr | None:
        """The key for an address. A model's key file is for the model's own address and goes to no other."""
        from scope_ptz.endpoints.endpoint import key_from_file

        own = model.key_file if model is not None and model.url == url else None
        chosen = file or own
        return key_from_file(chosen) if chosen else from_environment


def read_pair(registry: Registry, text: str) -> tuple[str, str]:
    """Planner and eyes of a pair by name, ``PLANNER+EYES``, or one model that is both; built-in ones may be in it.

    Raises ``UnknownNameError`` or ``ConfigError``.
    """
    planner, plus, eyes = text.partition("+")
    if text in registry.pairs or not plus or (planner != GRAMMAR and eyes not in BUILT_IN_PERCEPTION):
        pair = registry.pair(text)
        return pair.planner, pair.perception
    return (
        planner if planner == GRAMMAR else _in(registry, planner, "planner", (GRAMMAR,)),
        eyes if eyes in BUILT_IN_PERCEPTION else _in(registry, eyes, "perception", BUILT_IN_PERCEPTION),
    )


def _in(registry: Registry, name: str, role: Role, built_in: Iterable[str]) -> str:
    try:
        return registry.model(name, role).name
    except UnknownNameError as error:
        raise UnknownNameError(role, name, [*built_in, *registry.named(role)]) from error


def parse_options(pairs: Iterable[str], option: str) -> dict[str, Any]:
    """``NAME=VALUE`` options; values are JSON where they can be read as such, words otherwise."""
    options: dict[str, Any] = {}
    for pair in pairs:
        name, equals, value = pair.partition("=")
        if not equals or not name.strip():
            raise InputError(f"{option} wants NAME=VALUE, got '{pair[:80]}'.")
        try:
            options[name.strip()] = json.loads(value)
        except ValueError:
            options[name.strip()] = value
    return options
