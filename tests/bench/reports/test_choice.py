"""The recommended pair of a report: ties are reported as ties, and the first screen names it before any statistics."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.choice.label_placement import LABEL_HALF_PT, label_offsets
from scope_ptz.bench.reports.choice.ties import compare_all, extreme_names, find_leaders, join_names
from scope_ptz.bench.reports.tables import MarkedCell, cell_value
from scope_ptz.bench.reports.terminal import terminal_lines
from scope_ptz.bench.reports.writer import render_html, render_markdown
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import card, evaluation, facts, trial
from tests.bench.reports.test_report import row, table

TASKS = facts(12)
PLANNERS = ("qwen3-4b", "qwen3-30b-a3b", "qwen3-32b")


def evaluation_with(
    planner: str, correct: Sequence[int], perception: str = "moondream2", seconds: float = 1.0, **extra: Any
) -> Evaluation:
    """Return an evaluation that is correct on the tasks with these indices."""
    template = evaluation(planner, perception, TASKS, 1.0, broken_share=0.0, judged=False, latency_s=(seconds, seconds))
    chosen = set(correct)
    trials = tuple(
        trial(t, "correct" if n in chosen else "incorrect", timings=old.timings, looks=old.looks)
        for n, (t, old) in enumerate(zip(TASKS, template.trials, strict=True))
    )
    return Evaluation(card=card(planner, perception, **extra), trials=trials, wanted=len(trials))


def build(*evaluations: Evaluation) -> EvaluationReport:
    return build_report(evaluations, load_registry())


def first_sentence(report: EvaluationReport) -> str:
    return report.sections[0].text[0]


def marked_cells(report: EvaluationReport, key: str) -> list[MarkedCell]:
    return [v for values in table(report, key).rows for v in values if isinstance(v, MarkedCell) and (v.best or v.best_of_all)]


def test_pairs_that_fail_everything_are_not_ranked() -> None:
    small_report = build(*(evaluation_with(planner, ()) for planner in PLANNERS))
    assert first_sentence(small_report).startswith("All 3 model pairs have the same macro accuracy, 0.0% (95% interval 0.0 to")
    assert first_sentence(small_report).endswith("so none is ahead.")
    assert not marked_cells(small_report, "accuracy")
    assert {cell_value(values[3]) for values in table(small_report, "choice").rows} == {"equal highest"}
    assert not any("highest accuracy" in str(values[2]) for values in table(small_report, "choice").rows)
    assert row(small_report, "spread_planner", "moondream2") == {
        "held": "moondream2", "pairs": 3, "lowest": "all equal", "low": 0.0, "highest": "all equal", "high": 0.0, "spread": 0.0,
        "differ": "not shown",
    }  # fmt: skip
    for text in (*small_report.summary, *terminal_lines(small_report), render_markdown(small_report)):
        assert "Highest macro accuracy" not in text and "Second:" not in text


def test_equal_pairs_share_the_first_place() -> None:
    half = range(0, 96, 2)
    small_report = build(
        evaluation_with("qwen3-4b", half), evaluation_with("qwen3-30b-a3b", half), evaluation_with("qwen3-32b", ())
    )
    # Equal pairs are ordered by latency. Both have the same latency here, so they keep the order of the report.
    assert "qwen3-4b + moondream2 and qwen3-30b-a3b + moondream2, 50.0%" in first_sentence(
        small_report
    ) and " each." in first_sentence(small_report)
    assert first_sentence(small_report).endswith("The paired comparisons show that every other pair is less accurate.")
    standings = {cell_value(values[0]): values[3] for values in table(small_report, "choice").rows}
    assert standings == {
        "qwen3-4b + moondream2": "equal highest", "qwen3-30b-a3b + moondream2": "equal highest", "qwen3-32b + moondream2": "lower"
    }  # fmt: skip
    spread = row(small_report, "spread_planner", "moondream2")
    assert (spread["highest"], spread["lowest"], spread["differ"]) == ("qwen3-30b-a3b, qwen3-4b", "qwen3-32b", "yes")
    best = row(small_report, "memory_fits", "160 GB")
    assert "(equal)" in str(best["tied"]) and "qwen3-32b" not in str(best["tied"])


def test_pairs_are_not_ranked_if_no_difference_is_shown() -> None:
    small_report = build(
        evaluation_with("qwen3-4b", range(0, 96, 2)),
        evaluation_with("qwen3-30b-a3b", [*range(0, 96, 2), 1]),
        evaluation_with("qwen3-32b", ()),
    )
    assert first_sentence(small_report).startswith("Highest macro accuracy: qwen3-30b-a3b + moondream2, 51.0%")
    assert "Not distinguishable from this in the paired comparisons: qwen3-4b + moondream2 (50.0%)." in first_sentence(small_report)
    assert first_sentence(small_report).endswith("The remaining pair is shown to be less accurate.")
    rows = {cell_value(values[0]): values for values in table(small_report, "accuracy").rows}
    note = rows["qwen3-4b + moondream2"][1]
    assert isinstance(note, MarkedCell) and note.note == "not distinguishable from the highest" and not note.best
    assert row(small_report, "memory_fits", "24 GB")["tied"] == "none"
    assert "qwen3-4b + moondream2" in str(row(small_report, "memory_fits", "160 GB")["tied"])
    assert {cell_value(v[0]): v[3] for v in table(small_report, "choice").rows}["qwen3-4b + moondream2"] == "not distinguishable"


def test_leaders_agree_with_the_table_of_comparisons(report: EvaluationReport) -> None:
    runs = [
        run for run in report.runs if run.ranked and not run.task_difference and run.task_set[1] == "core" and not run.system[3]
    ]
    found = compare_all(runs)
    best = find_leaders(runs, found)
    assert best is not None and set(best.highest) | set(best.close) | set(best.others) == set(runs)
    differ = {frozenset(values[:2]): values[11] for values in table(report, "comparisons").rows}
    for run in (*best.close, *best.others):
        document = differ[frozenset({run.label, best.highest[0].label})]
        assert document == ("yes" if run in best.others else "not shown")
    assert best.others or best.close
    assert find_leaders([], found) is None


@pytest.mark.full
def test_the_first_screen_names_the_fast_and_the_small_pair(report: EvaluationReport) -> None:
    small_report = build(
        evaluation_with("qwen3-4b", range(0, 96, 2), seconds=3.0),
        evaluation_with("qwen3-30b-a3b", [*range(0, 96, 2), 1], seconds=0.2),
        evaluation_with("qwen3-32b", (), seconds=9.0), evaluation_with("grammar", range(96), "ground-truth", seconds=0.01),
    )  # fmt: skip
    choose = {cell_value(values[0]): str(values[2]) for values in table(small_report, "choice").rows}
    assert choose["qwen3-30b-a3b + moondream2"] == "highest accuracy; lowest latency"
    assert choose["qwen3-4b + moondream2"] == "least memory"
    assert choose["qwen3-32b + moondream2"] == "–" and choose["grammar + ground-truth"] == "baseline"
    assert any("the fastest is qwen3-30b-a3b + moondream2" in line for line in small_report.sections[0].text)
    assert "1 of 3 pairs meets the 2 Hz bar" in " ".join(small_report.sections[0].text)
    baseline = row(small_report, "choice", "grammar + ground-truth")
    assert (baseline["number"], baseline["memory_gb"], baseline["standing"]) == ("", 0, "")
    (chart,) = small_report.sections[0].charts
    assert "Baselines: grammar + ground-truth 100.0%" in chart.alt and "2 Hz (0.5 s)" in chart.svg
    slow = build(evaluation_with("qwen3-4b", (1, 2), seconds=3.0))
    assert "The 2 Hz bar (0.5 s) is off the left edge of the chart" in slow.sections[0].charts[0].title
    page, text = render_html(report), render_markdown(report)
    for document in (page, text):
        assert document.index("Which pair to choose") < document.index("Summary") < document.index("Macro average")
    assert page.index("<svg") < page.index('id="accuracy"') and "charts/chart-front.svg" in text


def test_the_label_of_isolation_is_in_the_first_table() -> None:
    labels = ("in-process", "isolated", "sandboxed", "hosted")
    external = [evaluation_with("qwen3-4b", (1,), agent=f"mine:{label}", isolation=label) for label in labels]
    small_report = build(evaluation_with("qwen3-4b", (1,)), *external)
    assert row(small_report, "choice", "qwen3-4b + moondream2")["isolation"] == "built in"
    for label in labels:
        assert row(small_report, "choice", f"qwen3-4b + moondream2, agent mine:{label} ({label})")["isolation"] == label


def test_chance_corrected_accuracy_is_shown_if_the_tasks_are_known(report: EvaluationReport) -> None:
    assert {cell_value(values[5]) for values in table(report, "choice").rows} == {None}
    tasks = {task.id: task for task in load_split("lite")}
    trials = tuple(trial(facts_of(task, "here")) for task in tasks.values())
    run = Evaluation(card=card("qwen3-4b", "moondream2"), trials=trials, wanted=len(trials))
    small_report = build_report([run], load_registry(), tasks=tasks)
    assert row(small_report, "choice", "qwen3-4b + moondream2")["corrected"] == pytest.approx(1.0)


def test_the_terminal_shows_the_same_table(report: EvaluationReport) -> None:
    lines = list(terminal_lines(report))
    head = next(n for n, line in enumerate(lines) if line.startswith("Pair "))
    body = lines[head + 1 : head + 1 + len(table(report, "choice").rows)]
    assert [line.split("  ")[0].strip()[:40] for line in body] == [
        str(cell_value(values[0]))[:40] for values in table(report, "choice").rows
    ]
    assert not any("\x1b" in line for line in lines)


def test_control_characters_do_not_reach_the_terminal() -> None:
    small_report = build(evaluation_with("mine\x1b[2J\nx", (1, 2)))
    rows = [line for line in terminal_lines(small_report) if "moondream2" in line and "Macro" not in line]
    assert rows and not any("\x1b" in line or "\n" in line for line in rows)


def test_names_in_sentences() -> None:
    assert (join_names([]), join_names(["a"]), join_names(["a", "b"]), join_names(["a", "b", "c"])) == (
        "",
        "a",
        "a and b",
        "a, b and c",
    )
    assert join_names(list("abcdef")) == "a, b, c and 3 more"
    assert extreme_names([(0.5, "a"), (0.5 + 1e-12, "b"), (0.7, "c")]) == ("a, b", "c")


@given(
    st.lists(st.tuples(st.tuples(st.floats(40, 260), st.floats(40, 260)), st.floats(3, 14)), min_size=1, max_size=19),
)
def test_labels_stay_in_the_picture_and_near_their_points(points: list[tuple[tuple[float, float], float]]) -> None:
    offsets = label_offsets(points, (0, 0, 300, 300))
    for ((x, y), radius), (dx, dy) in zip(points, offsets, strict=True):
        assert radius < hypot(dx, dy) <= radius + 31
        assert LABEL_HALF_PT[0] - 1 <= x + dx <= 301 - LABEL_HALF_PT[0] and LABEL_HALF_PT[1] - 1 <= y + dy <= 301 - LABEL_HALF_PT[1]


def test_labels_of_a_cluster_do_not_overlap() -> None:
    points = [((100.0 + 9 * n, 100.0 + 4 * n), 5.0) for n in range(8)]
    places = [(x + dx, y + dy) for ((x, y), _), (dx, dy) in zip(points, label_offsets(points, (0, 0, 300, 300)), strict=True)]
    for n, (x, y) in enumerate(places):
        for u, v in places[:n]:
            assert abs(x - u) >= 2 * LABEL_HALF_PT[0] - 1 or abs(y - v) >= 2 * LABEL_HALF_PT[1] - 1


@pytest.mark.parametrize("number", [1, 2])
def test_runs_without_pairs_have_a_first_screen(number: int) -> None:
    small_report = build(*(evaluation_with("grammar", (1,), "ground-truth", variant=f"v{n}") for n in range(number)))
    assert first_sentence(small_report) == "These runs include no pair of models, so nothing is ranked."
    assert len(table(small_report, "choice").rows) == number and not small_report.sections[0].charts
