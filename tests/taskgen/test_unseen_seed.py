"""The seed of tasks in scene variations: the default gives the published tasks, and another seed gives other tasks."""

from __future__ import annotations

from typing import Any

import pytest

from scope_ptz.taskgen.authoring.assembly import BuiltTasks
from scope_ptz.taskgen.dataset import unseen


def test_another_seed_draws_other_tasks(monkeypatch: pytest.MonkeyPatch) -> None:
    seeds: list[int] = []

    def build(worlds: object, seed: int, *_: Any) -> BuiltTasks:
        seeds.append(seed)
        return BuiltTasks()

    monkeypatch.setattr(unseen, "build", build)
    unseen.build_unseen([], (7, 8, 9))
    for seed in (1, 2, 3, 2):
        unseen.build_unseen([], (7, 8, 9), seed=seed)
    published, default, second, third, repeated = seeds
    assert published == default == 1_000_000 + 7 + 8 * 31 + 9 * 31**2
    assert len({published, second, third}) == 3
    assert second == repeated
