"""Compare the models on a run card with the models named in traces.

Results of the built-in planner or ground-truth perception must not be attributed to a model.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from scope_ptz.bench.engine.stored_run import StoredRun
from scope_ptz.bench.scoring.trials import RunCard
from scope_ptz.builtin_names import DETERMINISTIC, NOISY_SOURCE


def models_of(stored_run: StoredRun) -> tuple[str, str]:
    """Return the planner and perception names in the first line of a trace; empty names if the line cannot be read."""
    try:
        started = json.loads(stored_run.trace.partition("\n")[0])
        return str(started["planner"]), str(started["perception"])
    except (ValueError, KeyError, TypeError):
        return "", ""


def card_contradictions(models: Sequence[tuple[str, str]], card: RunCard) -> Iterator[str]:
    """Yield a sentence for each role in which the card names a model but traces name a built-in component, or vice versa.

    Args:
        models: The planner and perception names in each trace.
        card: The run card.
    """
    for index, (role, model) in enumerate((("planner", card.planner), ("perception", card.perception))):
        role_names = [names[index] for names in models if names[index]]
        contradicting_names = [name for name in role_names if (name in (*DETERMINISTIC, NOISY_SOURCE)) is not model.deterministic]
        if contradicting_names:
            yield f"the {role} is {model.name} on the card, but {contradicting_names[0]} in {len(contradicting_names)} traces"
