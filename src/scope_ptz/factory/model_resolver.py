"""Resolve model options, the model registry and environment variables to a planner and a perception backend."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scope_ptz.builtin_names import BUILT_IN_PERCEPTION, CHAT, GRAMMAR, HYBRID_PREFIX
from scope_ptz.entry_points import PERCEPTION, PLANNERS, find, installed, normalised
from scope_ptz.errors import ConfigError, InputError, UnknownNameError
from scope_ptz.factory.model_specs import ModelOptions, ResolvedPair, ResolvedPerception, ResolvedPlanner
from scope_ptz.factory.option_values import parse_options
from scope_ptz.factory.served_names import registered_model, with_served_name
from scope_ptz.settings import ScopeSettings

if TYPE_CHECKING:
    from pydantic import SecretStr

    from scope_ptz.endpoints.endpoint import Endpoint
    from scope_ptz.perception.backends.spec import BackendSpec
    from scope_ptz.planner.chat import ChatOptions
    from scope_ptz.registry import Model, Registry, Role

CHAT_BACKEND = "openai_vision"

BACKENDS_WITH_SERVER = ("moondream", CHAT_BACKEND)
"""Backends that always require a server."""

BACKENDS_WITHOUT_SERVER = ("ocr", "router", "transformers_local", "zero_shot")
"""Backends that never use a server. Plug-ins are in neither list: they receive an endpoint if the user specifies a URL."""


class ModelResolver:
    """Resolves the user's model options to a planner and a perception backend.

    Args:
        options: The user's options.
        settings: Defaults from the environment.
    """

    def __init__(self, options: ModelOptions, settings: ScopeSettings) -> None:
        from scope_ptz.registry import load_registry

        self.options, self.settings = options, settings
        self.registry: Registry = load_registry(settings.models_file())

    async def resolve(self) -> ResolvedPair:
        """Return the planner and the perception backend.

        Raises:
            InputError: A name, a URL or a combination of options is invalid.
        """
        options = self.options
        planner, perception = options.planner, options.perception
        if options.pair is not None:
            if planner is not None or perception is not None:
                raise InputError("Use either --pair or --planner and --perception, not both.")
            planner, perception = read_pair(self.registry, options.pair)
        planner = planner or (CHAT if options.planner_url or options.planner_model else GRAMMAR)
        perception = perception or (CHAT_BACKEND if options.perception_url or options.perception_model else BUILT_IN_PERCEPTION[0])
        one_model = planner.removeprefix(HYBRID_PREFIX) == perception
        resolved = await self._planner(planner, sees=one_model)
        return ResolvedPair(resolved, self._with_router(await self._perception(perception, resolved if one_model else None)))

    async def _planner(self, name: str, *, sees: bool) -> ResolvedPlanner:
        options = self.options
        if name.startswith(HYBRID_PREFIX):
            return await self._hybrid(name.removeprefix(HYBRID_PREFIX), sees=sees)
        if name == GRAMMAR:
            if options.planner_url or options.planner_model or options.planner_options or options.planner_key_file:
                raise InputError(
                    "The grammar planner has no server and no options. Remove the --planner-... options, or choose a model."
                )
            return ResolvedPlanner(GRAMMAR)
        if self._is_plugin_planner(name):
            return self._plugin_planner(name)
        model = self._registered_planner(name) if name != CHAT else None
        url = options.planner_url or (model.url if model else "") or self.settings.planner_url
        key = self._key(options.planner_key_file, model, url, self.settings.planner_key)
        endpoint = self._endpoint(url, key, "planner", name, model)
        served = options.planner_model or (name if model is None and name != CHAT else None)
        endpoint = await with_served_name(endpoint, served, model, "--planner-model")
        model = model or registered_model(self.registry, endpoint.model, "planner")
        return ResolvedPlanner(model.name if model else endpoint.model, endpoint, self._chat_options(model, sees=sees), model)

    async def _hybrid(self, model: str, *, sees: bool) -> ResolvedPlanner:
        """Resolve a hybrid planner, given the name of its language model or plug-in."""
        if model in ("", GRAMMAR) or model.startswith(HYBRID_PREFIX):
            raise InputError(
                f"'{HYBRID_PREFIX}{model}' does not name a language model. Add the model that plans the instructions that the "
                f"grammar does not understand, for example {HYBRID_PREFIX}qwen3.5-4b, or {HYBRID_PREFIX}{CHAT} with --planner-url."
            )
        resolved = await self._planner(model, sees=sees)
        return replace(resolved, name=f"{HYBRID_PREFIX}{resolved.name}", is_hybrid=True)

    def _is_plugin_planner(self, name: str) -> bool:
        """Return whether a name selects a plug-in. Built-in and registered names take precedence."""
        return name != CHAT and name not in self.registry.model_names("planner") and find(PLANNERS, name) is not None

    def _plugin_planner(self, name: str) -> ResolvedPlanner:
        from scope_ptz.planner.spec import PlannerSpec

        options = self.options
        url = options.planner_url or self.settings.planner_url
        key = self._key(options.planner_key_file, None, url, self.settings.planner_key)
        endpoint = self._endpoint(url, key, "planner", name, None) if url else None
        plugin_options = parse_options(options.planner_options, "--planner-option")
        spec = PlannerSpec(name=name, model=options.planner_model or "", endpoint=endpoint, options=plugin_options)
        return ResolvedPlanner(name, plugin=spec)

    def _chat_options(self, model: Model | None, *, sees: bool) -> ChatOptions:
        from pydantic import ValidationError

        from scope_ptz.planner.chat import ChatOptions

        chat_options: dict[str, Any] = {}
        if model is not None:
            # Thinking delays every camera move, so it is off unless --planner-option thinking=on is given.
            chat_options = {"family": model.repo, "sees": sees and model.sees}
            chat_options |= {"thinking": "off"} if model.thinking in ("default", "always") else {}
        chat_options |= parse_options(self.options.planner_options, "--planner-option")
        try:
            return ChatOptions.model_validate(chat_options)
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            path = ".".join(str(part) for part in first["loc"])
            raise ConfigError(
                f"--planner-option {path}: {first['msg']}. Known options: {', '.join(ChatOptions.model_fields)}."
            ) from None

    async def _perception(self, name: str, shared: ResolvedPlanner | None) -> ResolvedPerception:
        options = self.options
        if name in BUILT_IN_PERCEPTION:
            if options.perception_url or options.perception_model or options.perception_options or options.perception_key_file:
                raise InputError(
                    f"The backend '{name}' has no server and no options. Remove the --perception-... options, or choose a model."
                )
            return ResolvedPerception(name)
        if shared is not None and shared.endpoint is not None and not (options.perception_url or options.perception_model):
            return self._spec(name, shared.model, shared.endpoint)
        model = self._registered_perception(name)
        backend = self._backend(name, model)
        from_environment = "" if backend in BACKENDS_WITHOUT_SERVER else self.settings.perception_url
        url = options.perception_url or (model.url if model else "") or from_environment
        if not url and backend not in BACKENDS_WITH_SERVER:
            return self._spec(name, model, None)
        key = self._key(options.perception_key_file, model, url, self.settings.perception_key)
        endpoint = self._endpoint(url, key, "perception", name, model)
        if backend == CHAT_BACKEND:
            endpoint = await with_served_name(endpoint, options.perception_model, model, "--perception-model")
            model = model or registered_model(self.registry, endpoint.model, "perception")
        return self._spec(name, model, endpoint)

    def _spec(self, name: str, model: Model | None, endpoint: Endpoint | None) -> ResolvedPerception:
        from scope_ptz.perception.backends.spec import BackendSpec
        from scope_ptz.planner.chat.families import reasoning_switch, usual_server

        options = dict(parse_options(self.options.perception_options, "--perception-option"))
        options.pop("backend", None)
        backend = self._backend(name, model)
        coordinates = options.pop("coordinates", None) or (model.coordinates if model else "generic")
        if backend == CHAT_BACKEND and endpoint is not None and "extra" not in options:
            no_thinking = reasoning_switch(model.repo if model else endpoint.model, "off", usual_server(endpoint.url)).fields
            options |= {"extra": dict(no_thinking)} if no_thinking else {}
        served = self.options.perception_model or (endpoint.model if endpoint else "") or (model.repo if model else "")
        label = model.name if model else (served or name)
        spec = BackendSpec(name=label, backend=backend, model=served, endpoint=endpoint, coordinates=coordinates, options=options)
        return ResolvedPerception(label, spec, model)

    def _backend(self, name: str, model: Model | None) -> str:
        requested = parse_options(self.options.perception_options, "--perception-option").get("backend")
        return normalised(str(requested or (model.backend if model else name)))

    def _with_router(self, perception: ResolvedPerception) -> ResolvedPerception:
        """Combine the perception backend with the requested reader and detector in a router, if there are any."""
        from scope_ptz.perception.backends.spec import BackendSpec

        requested = {"reader": self.options.reader, "detector": self.options.detector}
        parts = {role: self._part_spec(name) for role, name in requested.items() if name}
        if not parts:
            return perception
        if perception.spec is None:
            raise InputError(
                f"--reader and --detector require a perception model, but '{perception.name}' is not one. Remove these options, "
                "or choose a model with --perception."
            )
        label = "+".join((perception.name, *(part.name for part in parts.values())))
        options = {"answerer": perception.spec, **parts}
        return ResolvedPerception(label, BackendSpec(name=label, backend="router", options=options), perception.model)

    def _part_spec(self, name: str) -> BackendSpec:
        from scope_ptz.perception.backends.spec import BackendSpec

        model = self._registered_perception(name)
        if model is None:
            return BackendSpec(name=name, backend=normalised(name))
        endpoint = (
            self._endpoint(model.url, self._key(None, model, model.url, None), "perception", name, model) if model.url else None
        )
        return BackendSpec(
            name=model.name, backend=model.backend, model=model.repo, endpoint=endpoint, coordinates=model.coordinates
        )

    def _registered_planner(self, name: str) -> Model | None:
        """Return the registry entry for a planner; None if it is not registered but the user specified its server's URL."""
        try:
            return self.registry.model(name, "planner")
        except UnknownNameError as error:
            if self.options.planner_url:
                return None
            plugins = (entry.name for entry in installed(PLANNERS))
            raise UnknownNameError("planner", name, [GRAMMAR, CHAT, *self.registry.model_names("planner"), *plugins]) from error

    def _registered_perception(self, name: str) -> Model | None:
        """Return the registry entry for a perception model; None if the name is that of a backend."""
        from scope_ptz.perception.backends import backend_names, built_in_backends

        if normalised(name) in built_in_backends():
            return None
        try:
            return self.registry.model(name, "perception")
        except UnknownNameError as error:
            if find(PERCEPTION, name) is not None:
                return None
            known = [*BUILT_IN_PERCEPTION, *self.registry.model_names("perception"), *backend_names()]
            raise UnknownNameError("perception", name, known) from error

    def _endpoint(self, url: str, key: SecretStr | None, role: str, name: str, model: Model | None) -> Endpoint:
        from scope_ptz.endpoints.endpoint import Endpoint, Timeouts

        if not url:
            hint = f" `scope models serve-command {model.name}` prints the command that starts one." if model else ""
            raise ConfigError(f"'{name}' requires a model server. Specify its URL with --{role}-url.{hint}")
        total = self.options.timeout_s
        return Endpoint(url=url, key=key, timeouts=Timeouts() if total is None else Timeouts.within(total))

    @staticmethod
    def _key(file: Path | None, model: Model | None, url: str, from_environment: SecretStr | None) -> SecretStr | None:
        """Return the API key for a URL. A registered model's key file is used only for that model's own URL."""
        from scope_ptz.endpoints.endpoint import key_from_file

        registered = model.key_file if model is not None and model.url == url else None
        path = file or registered
        return key_from_file(path) if path else from_environment


def read_pair(registry: Registry, text: str) -> tuple[str, str]:
    """Return the names of a pair's planner and perception backend.

    Args:
        registry: The registered models and pairs.
        text: The name of a pair, ``PLANNER+PERCEPTION``, or a single model for both roles. Either part may be built in or provided
            by a plug-in.

    Raises:
        UnknownNameError: A name is unknown.
        ConfigError: A model does not support its role.
    """
    planner, plus, perception = text.partition("+")
    if text in registry.pairs or not plus:
        pair = registry.pair(text)
        return pair.planner, pair.perception
    return _role_name(registry, planner, "planner"), _role_name(registry, perception, "perception")


def _role_name(registry: Registry, name: str, role: Role) -> str:
    """Check a name for a role, and return the name of the built-in, the registered model or the plug-in."""
    if role == "planner" and name.startswith(HYBRID_PREFIX):
        return HYBRID_PREFIX + _role_name(registry, name.removeprefix(HYBRID_PREFIX), role)
    built_in, group = ((GRAMMAR,), PLANNERS) if role == "planner" else (BUILT_IN_PERCEPTION, PERCEPTION)
    if name in built_in:
        return name
    try:
        return registry.model(name, role).name
    except UnknownNameError as error:
        if find(group, name) is not None:
            return name
        raise UnknownNameError(role, name, [*built_in, *registry.model_names(role)]) from error
