"""The calls of a plan as text, to compare many wordings."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.plan import plan


def planned_calls(instruction: str, presets: Sequence[str], *, with_names: bool = False) -> str:
    """Return the calls of a plan, such as "count_objects(cars, current); take_image()"; the question if it is not understood.

    Args:
        instruction: The user's text.
        presets: The camera's presets.
        with_names: Whether to write the names of the arguments: "adjust_ptz(pan_deg=20)".
    """
    made = plan(instruction, presets)
    texts = [
        f"{call.name}({', '.join(f'{name}={value}' if with_names else str(value) for name, value in call.arguments.items())})"
        for call in made.calls
    ]
    return made.clarification or "; ".join(texts)


def count(things: str, view: str = "current") -> str:
    """Return the text of a count."""
    return f"count_objects({things}, {view})"


def ask(question: str, view: str = "current") -> str:
    """Return the text of a question about the picture."""
    return f"query_answer({question}, {view})"


def zoom(thing: str) -> str:
    """Return the text of a zoom to a thing."""
    return f"zoom_to_object({thing})"
