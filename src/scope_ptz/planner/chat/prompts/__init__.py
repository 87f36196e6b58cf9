"""Load the system prompts, which are versioned files.

A released file is never changed. An improved prompt is a new file with the next number, so that runs remain comparable.
"""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from string import Template

from scope_ptz.errors import ConfigError, UnknownNameError
from scope_ptz.geometry import Limits, Pose

DEFAULT_PROMPT = "standard-1"
_WITHOUT_PICTURES = (
    "You see nothing yourself: what the camera sees you learn from the results of count_objects, query_answer, zoom_to_object and "
    "track_object."
)
_WITH_PICTURES = (
    "The last image is always the newest view of the camera; use it. count_objects, query_answer, zoom_to_object and track_object "
    "look more closely, and further than this view."
)


@dataclass(frozen=True, slots=True)
class Prompt:
    """A system prompt with placeholders for facts about the camera (``$presets``, ``$pan``, ...)."""

    name: str
    text: str
    about: str = ""

    @property
    def digest(self) -> str:
        """A short hash that identifies the exact text in a trace."""
        return sha256(self.text.encode()).hexdigest()[:12]

    def fill(self, presets: tuple[str, ...], limits: Limits, start: Pose, *, accepts_images: bool = False) -> str:
        """Return the prompt's text for a camera.

        Args:
            presets: The camera's presets.
            limits: The camera's limits.
            start: The camera's pose when the conversation starts.
            accepts_images: Whether the planner accepts images.

        Raises:
            ConfigError: The prompt has an unknown or malformed placeholder.
        """
        pose = start.as_dict()
        numbers = {
            "min_tilt": limits.min_tilt_deg,
            "max_tilt": limits.max_tilt_deg,
            "min_zoom": limits.min_zoom,
            "max_zoom": limits.max_zoom,
            "pan": pose["pan_deg"],
            "tilt": pose["tilt_deg"],
            "zoom": pose["zoom"],
        }
        values = {name: f"{value:g}" for name, value in numbers.items()}
        values["min_pan"], values["max_pan"] = f"{limits.min_pan_deg:g}", f"{limits.max_pan_deg:g}"
        if limits.pan_endless:
            values["max_pan"] += " (endless)"
        values["presets"] = ", ".join(" ".join(name.split()) for name in presets) if presets else "none"
        values["sight"] = _WITH_PICTURES if accepts_images else _WITHOUT_PICTURES
        try:
            return Template(self.text).substitute(values)
        except (KeyError, ValueError) as error:
            raise ConfigError(f"The prompt {self.name} has an unknown or malformed placeholder: {error}.") from error


def prompt_names() -> tuple[str, ...]:
    """Return the names of the packaged prompts."""
    return tuple(sorted(f.name.removesuffix(".md") for f in files(__package__).iterdir() if f.name.endswith(".md")))


def load_prompt(name: str = DEFAULT_PROMPT) -> Prompt:
    """Return a packaged prompt by name.

    Raises:
        UnknownNameError: There is no such prompt.
    """
    names = prompt_names()
    if name not in names:
        raise UnknownNameError("prompt", name, names)
    _, head, text = (files(__package__) / f"{name}.md").read_text(encoding="utf-8").split("---\n", 2)
    return Prompt(name, text.strip(), head.partition("about:")[2].strip())
