"""Reasoning switches and sampling temperatures by model family.

To support a new family, add an entry to ``FAMILIES``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal
from urllib.parse import urlsplit

Thinking = Literal["default", "on", "off"]
Server = Literal["vllm", "sglang", "llama.cpp", "ollama", "transformers", "lm-studio", "openai"]


@dataclass(frozen=True, slots=True)
class Switch:
    """The request data that switches reasoning on or off.

    Attributes:
        fields: Request fields.
        words: Text to append to the user message, for servers that ignore the fields.
    """

    fields: Mapping[str, Any] = field(default_factory=dict)
    words: str = ""


_NO_SWITCH = Switch()


def _template(key: str, value: bool) -> Switch:
    return Switch({"chat_template_kwargs": {key: value}})


@dataclass(frozen=True, slots=True)
class Family:
    """A model family. ``pattern`` is a regular expression for model names; the first family that matches is used.

    Attributes:
        reasons_by_default: Whether the family's models reason by default.
        on: The request data that turns reasoning on; None if requests cannot turn it on.
        off: The request data that turns reasoning off; None if requests cannot turn it off.
        temperatures: The sampling temperatures with and without reasoning; None selects the server's default. With reasoning,
            greedy sampling tends to loop, so the value recommended by the model's authors is used. Without reasoning, 0 makes
            calls reproducible.
    """

    name: str
    pattern: str
    reasons_by_default: bool
    on: Switch | None = None
    off: Switch | None = None
    temperatures: tuple[float | None, float | None] = (None, 0.0)


_QWEN_TEMPERATURES = (0.6, 0.0)
FAMILIES: tuple[Family, ...] = (
    Family("qwen3-thinking", r"qwen3.*thinking", reasons_by_default=True, temperatures=_QWEN_TEMPERATURES),
    Family(
        "qwen3-instruct", r"qwen3(?!.*32b).*(instruct|2507|next|coder)", reasons_by_default=False, temperatures=_QWEN_TEMPERATURES
    ),
    Family(
        "qwen3.5",
        r"qwen3\.[5-9]|qwen-?3\.[5-9]",
        reasons_by_default=True,
        on=_template("enable_thinking", True),
        off=_template("enable_thinking", False),
        temperatures=_QWEN_TEMPERATURES,
    ),
    Family(
        "qwen3",
        r"qwen-?3",
        reasons_by_default=True,
        on=Switch({"chat_template_kwargs": {"enable_thinking": True}}, "/think"),
        off=Switch({"chat_template_kwargs": {"enable_thinking": False}}, "/no_think"),
        temperatures=_QWEN_TEMPERATURES,
    ),
    Family(
        "smollm3",
        r"smollm-?3",
        reasons_by_default=True,
        on=Switch({}, "/think"),
        off=Switch({}, "/no_think"),
        temperatures=(0.6, 0.0),
    ),
    Family(
        "gpt-oss",
        r"gpt-oss",
        reasons_by_default=True,
        on=Switch({"reasoning_effort": "medium"}),
        off=Switch({"reasoning_effort": "low"}),  # reasoning cannot be switched off, only shortened
        temperatures=(1.0, 1.0),
    ),
    Family("glm", r"glm-?4\.[5-9]|glm-?[5-9]", True, _template("enable_thinking", True), _template("enable_thinking", False)),
    Family("gemma-4", r"gemma-?4", False, _template("enable_thinking", True), _template("enable_thinking", False)),
    Family("granite", r"granite-?3\.[2-9]", False, _template("thinking", True), _template("thinking", False)),
    Family("deepseek-v3", r"deepseek-v3\.[1-9]", False, _template("thinking", True), _template("thinking", False)),
    Family("deepseek-r1", r"deepseek-r1", reasons_by_default=True, temperatures=(0.6, 0.6)),
)
UNKNOWN = Family("unknown", "", reasons_by_default=False)

_OLLAMA_SWITCHES = {"on": Switch({"reasoning_effort": "medium"}), "off": Switch({"reasoning_effort": "none"})}
"""The switches for Ollama, which silently drops template arguments."""

_USUAL_ADDRESSES: tuple[tuple[str, Server], ...] = ((":11434", "ollama"), (":1234", "lm-studio"), ("api.openai.com", "openai"))


def family_of(model: str) -> Family:
    """Return the family to which a model belongs, by its name; ``UNKNOWN`` if no pattern matches."""
    name = model.lower()
    return next((f for f in FAMILIES if re.search(f.pattern, name)), UNKNOWN)


def usual_server(url: str) -> Server | None:
    """Return the server program that usually listens on an address; None for other addresses."""
    address = urlsplit(url).netloc
    return next((server for part, server in _USUAL_ADDRESSES if part in address), None)


def reasoning_switch(model: str, thinking: Thinking, server: Server | None) -> Switch:
    """Return the request data that switches a model's reasoning on or off.

    The switch is empty for "default" and for models that cannot be switched. On OpenAI's servers, a model from an unknown family
    gets a ``reasoning_effort``.
    """
    if thinking == "default":
        return _NO_SWITCH
    family = family_of(model)
    chosen = family.on if thinking == "on" else family.off
    if server == "openai":
        return Switch({"reasoning_effort": "medium" if thinking == "on" else "low"}) if family is UNKNOWN else chosen or _NO_SWITCH
    if chosen is None:
        return _NO_SWITCH
    if server == "ollama" and "chat_template_kwargs" in chosen.fields:
        return Switch(_OLLAMA_SWITCHES[thinking].fields, chosen.words)
    return chosen


def temperature_for(model: str, thinking: Thinking) -> float | None:
    """Return the sampling temperature for a model in a reasoning mode; None selects the server's default."""
    family = family_of(model)
    reasons = family.reasons_by_default if thinking == "default" else thinking == "on"
    return family.temperatures[0 if reasons else 1]
