"""The whole dataset in one go: every split, its proof, and the gold runs of the error modes."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import anyio

from scope_ptz.bench.tasks.splits import write_manifest, write_splits
from scope_ptz.cli.bench_build import tell_short
from scope_ptz.cli.bench_gold import made_gold, matrix_lines
from scope_ptz.cli.bench_proof import prove
from scope_ptz.cli.endings import complain, put
from scope_ptz.factory.validation_perception import answered
from scope_ptz.taskgen.authoring.assembly import build
from scope_ptz.taskgen.dataset.card import GOLD, PROOF
from scope_ptz.taskgen.dataset.unseen import build_unseen
from scope_ptz.taskgen.gold.gold_runs import write_gold

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from scope_ptz.bench.tasks.task import Category
    from scope_ptz.simulator.pack import Scene


def build_dataset(
    scenes: Mapping[str, Scene], out: Path, seed: int, numbers: Sequence[int], quotas: dict[Category, int] | None
) -> bool:
    """Write everything into a folder; whether all of it is as it should be. The same scenes and numbers give the same bytes."""
    core = build(list(scenes.values()), seed, quotas, complain, answered)
    unseen = build_unseen(list(scenes.values()), numbers, quotas, lambda said: complain(f"unseen {said}"), answered)
    short = [tell_short(core), tell_short(unseen, " unseen")]
    written = write_splits(core.tasks, unseen.tasks, out, seed=seed)
    put(f"{len(core.tasks)} tasks and {len(unseen.tasks)} unseen ones in {out}")

    proofs = {}
    for name, tasks in (("published", core.tasks), ("unseen", unseen.tasks)):
        proofs[name] = prove(tasks, seed, partial(_tell, f"{name}: proved"))
        put(f"{name}: {'sound' if proofs[name].sound else 'NOT SOUND: see scope bench validate'}")
    written.append(out / PROOF)
    written[-1].write_text(json.dumps({name: proof.as_dict() for name, proof in proofs.items()}, indent=1) + "\n", "utf-8")

    gold = anyio.run(made_gold, [task for task in core.tasks if task.stratum == "core"], seed)
    written.append(out / GOLD)
    write_gold(gold, written[-1])
    for line in matrix_lines(gold):
        put(line)
    write_manifest(out, written, scenes.values(), seed=seed, unseen=list(numbers), **({} if quotas is None else {"quotas": quotas}))
    return not any(short) and all(proof.sound for proof in proofs.values())


def _tell(what: str, done: int, of: int) -> None:
    if done % 100 == 0 or done == of:
        complain(f"{what} {done} of {of}")
