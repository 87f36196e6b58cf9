"""The splits that can be evaluated, with task counts by category, and the packages that evaluations need."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec

from scope_ptz.bench.engine.run_totals import CATEGORIES
from scope_ptz.bench.tasks.splits import SPLITS, load_split
from scope_ptz.errors import InputError

PACKAGES = ("inspect_ai", "jinja2", "matplotlib", "scipy")
"""Packages from the ``bench`` extra that evaluations import."""


@dataclass(frozen=True, slots=True)
class InstalledSplit:
    """An installed split, with its total number of tasks and the number in each category."""

    name: str
    tasks: int
    by_category: dict[str, int]


@cache
def installed_splits() -> tuple[InstalledSplit, ...]:
    """Return the installed splits."""
    installed = []
    for name in SPLITS:
        try:
            tasks = load_split(name)
        except InputError:
            continue
        counts = Counter(task.category for task in tasks)
        by_category = {category: counts[category] for category in CATEGORIES if counts[category]}  # type: ignore[index]
        installed.append(InstalledSplit(name, len(tasks), by_category))
    return tuple(installed)


def missing_packages() -> str:
    """Return a message that names the missing packages; empty if evaluations can run on this machine."""
    missing = [name for name in PACKAGES if find_spec(name) is None]
    if not missing:
        return ""
    return f"Evaluations need packages that are missing: {', '.join(missing)}. Install them with: pip install 'scope-ptz[bench]'."
