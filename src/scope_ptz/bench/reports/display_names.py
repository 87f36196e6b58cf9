"""What logs call things, made presentable."""

from __future__ import annotations

from pathlib import PurePath

from scope_ptz.bench.scoring.trials import ModelCard
from scope_ptz.registry import Model

ASKED, LISTED = "model", ("/v1/models id", "/v1/models root")
"""Of what a card keeps of a server: the name that was asked for, and what its list of models says."""


def split_name(split: str) -> str:
    """A split as reports call it: of a file its name, not where it lay."""
    return PurePath(split.replace("\\", "/")).name or split


def served_instead(card: ModelCard, model: Model | None) -> str | None:
    """What the server called the model, where that is no name of the one that was wanted. None: it is one, or nothing is known.

    The name that was asked for decides. An alias is no other model where the list tells beside it which model it stands for.
    """
    told = [card.reported[place] for place in (ASKED, *LISTED) if card.reported.get(place)]
    if model is None or not told:
        return None
    wanted = {_plain(name) for name in (*model.served_names(), card.name)}
    asked = told[0]
    alias = card.reported.get(LISTED[0]) == asked and _plain(card.reported.get(LISTED[1], "")) in wanted
    return None if _plain(asked) in wanted or alias else asked


def _plain(name: str) -> str:
    """A model's name without its maker or folder, and without regard to case."""
    return PurePath(name.replace("\\", "/")).name.lower()
