"""Determine the names of splits and models in reports."""

from __future__ import annotations

from pathlib import PurePath

from scope_ptz.bench.scoring.trials import ModelCard
from scope_ptz.registry import Model

REPLY_KEY, LIST_KEYS = "model", ("/v1/models id", "/v1/models root")
"""Keys in ``ModelCard.reported``: the model name in replies, and the names in the server's model list."""


def split_name(split: str) -> str:
    """Return the display name of a split. For a task file, it is the file name without the folder."""
    return PurePath(split.replace("\\", "/")).name or split


def unexpected_model(card: ModelCard, model: Model | None) -> str | None:
    """Return the name of the model that a server served instead of the requested model.

    A served name that is an alias of the requested model, according to the server's model list, counts as the requested model.

    Returns:
        The name, or None if the requested model was served or the served model is unknown.
    """
    reported = [card.reported[key] for key in (REPLY_KEY, *LIST_KEYS) if card.reported.get(key)]
    if model is None or not reported:
        return None
    requested = {_base_name(name) for name in (*model.served_names(), card.name)}
    served = reported[0]
    is_alias = card.reported.get(LIST_KEYS[0]) == served and _base_name(card.reported.get(LIST_KEYS[1], "")) in requested
    return None if _base_name(served) in requested or is_alias else served


def _base_name(name: str) -> str:
    """Return a model's name in lower case, without its organization or folder."""
    return PurePath(name.replace("\\", "/")).name.lower()
