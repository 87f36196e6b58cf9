"""Agreement between judges, repeats, checks and human labels on evaluations, and with known faults on gold runs."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import anyio
import pytest

from scope_ptz.bench.judging.agreement import collect_raters, measure_agreement
from scope_ptz.bench.judging.agreement_text import agreement_lines, agreement_text
from scope_ptz.bench.judging.json_lines import append_line
from scope_ptz.bench.judging.judge import Completion, Judge, NoReplyError
from scope_ptz.bench.judging.kappa import cohen_agreement
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Evaluation, Judgement, Label, ModelCard, RunCard, Trial
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.errors import InputError
from scope_ptz.taskgen.gold.judge_cases import result_lines
from scope_ptz.taskgen.gold.judge_results import (
    GoldCase,
    GoldVerdict,
    alternating_modes,
    gold_case,
    gold_raters,
    judge_gold,
    judge_result,
    judge_results,
    passing_case,
    read_verdicts,
)
from scope_ptz.taskgen.gold.mutations import FaultContext, GoldRun, mutate
from tests.bench.judging.runs import PRESET_VIEWPOINTS
from tests.bench.sample_runs import FRAME, PRESETS, samples

CARD = RunCard(
    run_id="run", started="2026-01-01T00:00:00Z", package_version="0", engine_version="0", dataset="scope1", dataset_digest="0",
    split="core", planner=ModelCard(name="p"), perception=ModelCard(name="e"), max_steps=60,
)  # fmt: skip
MODES = list(ErrorMode)


def judgement(verdict: str, judge: str = "one", prompt: str = "judge-1:0", mode: ErrorMode | None = None) -> Judgement:
    if verdict == "incorrect" and mode is None:
        mode = ErrorMode.REASONING
    return Judgement.model_validate({"judge": judge, "prompt": prompt, "verdict": verdict, "error_mode": mode, "reason": "x"})


def trial(number: int, headline: str, *judgements: Judgement, labels: tuple[Label, ...] = (), **extra: Any) -> Trial:
    task, _ = samples()[number % len(samples())]
    facts = facts_of(task, "mast").model_copy(update={"id": f"scope1-test-{number:03d}"})
    mode = ErrorMode.REASONING if headline == "incorrect" else None
    return Trial.model_validate(
        {
            "task": facts, "sample": f"{facts.id}#1", "headline": headline, "reason": "", "error_mode": mode, "outcome": "answered",
            "answer": "", "judgements": judgements, "labels": labels, **extra,
        }
    )  # fmt: skip


def evaluation(*trials: Trial) -> Evaluation:
    return Evaluation(card=CARD, trials=trials, wanted=len(trials), log="a.eval")


def test_all_raters_are_found_and_compared() -> None:
    ann = (Label(by="ann", verdict="incorrect", error_mode=ErrorMode.SCOPE),)
    report = measure_agreement(
        collect_raters(
            [
                evaluation(
                    trial(1, "correct", judgement("correct"), judgement("incorrect"), judgement("correct", "two")),
                    trial(2, "incorrect", judgement("incorrect"), judgement("incorrect"), judgement("correct", "two"), labels=ann),
                    trial(3, "correct", judgement("incorrect"), judgement("unparseable"), judgement("failed", "two")),
                    trial(4, "unscored", judgement("correct", "two"), labels=(Label(by="ann", verdict="unclear"),)),
                    trial(5, "infrastructure"),
                    trial(6, "correct", judgement("correct"), scored_by="judge"),
                )
            ]
        )
    )
    names = {rater.name: rater for rater in report.raters}
    assert [rater.kind for rater in report.raters] == ["checks", "judge", "judge", "judge", "person"]
    assert len(names["the checks"].ratings) == 3
    assert names["the checks"].other_verdicts == Counter(unscored=1, infrastructure=1)
    assert names["one (judge-1:0) #2"].other_verdicts == Counter(unparseable=1)
    assert names["two (judge-1:0)"].other_verdicts == Counter(failed=1)
    assert names["ann"].other_verdicts == Counter(unclear=1)
    pairs = {(pair.first, pair.second): pair for pair in report.pairs}
    checks_one = pairs["the checks", "one (judge-1:0)"].verdicts
    assert checks_one.runs == 3
    assert checks_one.raw == pytest.approx(2 / 3)
    assert ("the checks", "one (judge-1:0) #2") not in pairs, "repeats must be compared only with each other"
    repeats = pairs["one (judge-1:0)", "one (judge-1:0) #2"].verdicts
    assert (repeats.runs, repeats.raw) == (2, 0.5)
    groups = {group.title: group for group in report.groups}
    assert groups["repeats of one (judge-1:0)"].partly_rated == 2
    assert groups["judges"].verdicts.runs == 2
    assert pairs["the checks", "ann"].modes.confusion == (("reasoning", "scope", 1),)


def test_one_model_under_two_prompts_is_two_judges() -> None:
    report = measure_agreement(
        collect_raters([evaluation(trial(1, "correct", judgement("correct"), judgement("correct", prompt="judge-2:0")))])
    )
    assert [pair.first for pair in report.pairs] == ["the checks", "the checks", "one (judge-1:0)"]


def test_runs_of_different_logs_are_different_runs() -> None:
    one = evaluation(trial(1, "correct", judgement("correct")))
    two = evaluation(trial(1, "incorrect", judgement("correct"))).model_copy(update={"log": "b.eval"})
    (pair,) = measure_agreement(collect_raters([one, two])).pairs
    assert pair.verdicts.runs == 2


def test_the_report_as_text_and_as_json() -> None:
    rows = [trial(n, "correct" if n % 2 else "incorrect", judgement("correct" if n % 3 else "incorrect")) for n in range(12)]
    report = measure_agreement(collect_raters([evaluation(*rows)]))
    text = "\n".join(agreement_lines(report))
    assert "the checks  against  one (judge-1:0)" in text
    assert "12 runs, agree on 50.0%" in text
    assert "both correct 4, both incorrect 2, only the first correct 2, only the second 4" in text
    content = json.loads(json.dumps(report.as_dict()))
    assert content["pairs"][0]["verdicts"]["kappa"] == pytest.approx(0.0)
    assert agreement_text(cohen_agreement(["correct"], ["correct"], ["t"], 1)).startswith("1 run, agree on 100.0%")
    assert agreement_text(cohen_agreement([], [], [], 1)) == "no run was rated by both"
    assert "contain no ratings" in next(iter(agreement_lines(measure_agreement([]))))


# Gold runs


def gold_runs() -> list[GoldRun]:
    import random

    context = FaultContext(PRESETS, FRAME)
    candidates = (mutate(task, episode, mode, context, random.Random(7)) for task, episode in samples() for mode in MODES)
    return [gold for gold in candidates if gold is not None]


def all_cases() -> list[GoldCase]:
    cases = [gold_case(gold, PRESET_VIEWPOINTS) for gold in alternating_modes(gold_runs())]
    return [*cases, *(passing_case(task, episode, PRESET_VIEWPOINTS) for task, episode in samples())]


class Oracle:
    """A judge that knows which runs are faulty, with configurable errors."""

    def __init__(self, cases: list[GoldCase], *, accepts: str = "", fails: str = "") -> None:
        from scope_ptz.bench.judging.judge import judge_messages

        self.known = {judge_messages(case.facts, case.case)[1]["content"]: case for case in cases}
        self.accepts, self.fails, self.request_count = accepts, fails, 0

    async def __call__(self, judge_messages: list[dict[str, Any]], schema: dict[str, Any]) -> Completion:
        self.request_count += 1
        case = self.known[judge_messages[1]["content"]]
        if self.fails and case.fault == self.fails:
            raise NoReplyError("gone")
        wrong = case.fault is not None and case.fault != self.accepts
        content = {
            "verdict": "incorrect" if wrong else "correct",
            "error_mode": case.fault if wrong else "none",
            "reason": "so it is",
        }
        return Completion(text=json.dumps(content))


def verdicts_of(cases: list[GoldCase], port: Oracle, repeat: int = 0) -> list[GoldVerdict]:
    found = list[GoldVerdict]()

    async def work() -> None:
        await judge_gold(Judge("oracle", port), cases, repeat=repeat, note=found.append)

    anyio.run(work)
    return found


def test_gold_runs_differ_in_the_text_for_the_judge() -> None:
    cases = all_cases()
    assert len({case.key for case in cases}) == len(cases)
    assert {case.fault for case in cases} == {*MODES, None}


def test_a_perfect_judge_of_gold_runs() -> None:
    cases = all_cases()
    summary = judge_result("oracle", verdicts_of(cases, Oracle(cases)))
    assert (summary.false_accept_rate, summary.false_reject_rate) == (0.0, 0.0)
    assert summary.verdicts.kappa == pytest.approx(1.0)
    assert summary.modes.raw == 1.0
    assert summary.as_dict()["matrix"]["passes"] == {"correct": len(samples())}


def test_a_judge_that_misses_a_fault_and_a_judge_that_fails() -> None:
    cases = all_cases()
    scope_faults = sum(case.fault is ErrorMode.SCOPE for case in cases)
    query_faults = sum(case.fault is ErrorMode.VLM_QUERY for case in cases)
    summary = judge_result("oracle", verdicts_of(cases, Oracle(cases, accepts="scope", fails="vlm_query")))
    faulty = sum(case.fault is not None for case in cases) - query_faults
    assert summary.false_accept_rate == pytest.approx(scope_faults / faulty)
    assert summary.as_dict()["apart"] == {"unparseable": 0, "failed": query_faults}
    assert summary.cells["scope", "correct"] == scope_faults
    text = "\n".join(result_lines(summary))
    assert f"false accepts: {scope_faults / faulty:.1%}" in text
    assert "false rejects: 0.0%" in text
    assert summary.verdicts.kappa is not None
    assert 0 < summary.verdicts.kappa < 1


def test_verdicts_on_disk_and_their_repeats(tmp_path: Path) -> None:
    cases, path = all_cases()[:24], tmp_path / "deep" / "gold.jsonl"
    for repeat in range(2):
        for verdict in verdicts_of(cases, Oracle(cases, accepts="scope" if repeat else ""), repeat):
            append_line(path, verdict.model_dump_json())
    (summary,) = judge_results(read_verdicts(path))
    assert sum(summary.cells.values()) == 48
    raters = gold_raters(read_verdicts(path))
    assert [rater.name.split(" (")[0] for rater in raters] == ["the known faults", "oracle", "oracle"]
    report = measure_agreement(raters)
    known, repeats = report.pairs
    assert known.verdicts.raw == 1.0
    assert repeats.verdicts.raw is not None
    assert repeats.verdicts.raw < 1.0


def test_an_incomplete_line_is_ignored(tmp_path: Path) -> None:
    cases, path = all_cases()[:3], tmp_path / "gold.jsonl"
    one, two, three = verdicts_of(cases, Oracle(cases))
    append_line(path, one.model_dump_json())
    with path.open("a") as file:
        file.write(two.model_dump_json()[:50])
    assert [verdict.key for verdict in read_verdicts(path)] == [one.key]
    append_line(path, three.model_dump_json())
    assert [verdict.key for verdict in read_verdicts(path)] == [one.key, three.key]


@pytest.mark.parametrize("content", [b"{}\n", b"not json\n", b"\xff\xfe\n"])
def test_other_files_are_not_verdicts(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.jsonl"
    path.write_bytes(content)
    with pytest.raises(InputError):
        read_verdicts(path)
