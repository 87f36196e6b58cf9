"""The leaderboard page: ranks, labels, separate tables, and escaped text of submissions."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.bench.leaderboard.entries import LeaderboardEntry, RefusedSubmission, TaskSet
from scope_ptz.bench.leaderboard.page import BASELINE, leaderboard_html, leaderboard_tables, rank_entries, write_leaderboard
from scope_ptz.bench.reports.tables import cell_value
from scope_ptz.bench.signatures.provenance import Evaluated, Provenance
from scope_ptz.bench.submissions.submission import submission_lines
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.errors import OutputError
from tests.bench.reports.sample_evaluations import evaluation, facts

FACTS = facts(4)
ATTRIBUTES = {
    "lang", "charset", "name", "content", "http-equiv", "class", "id", "aria-label", "aria-labelledby", "role", "tabindex", "scope",
    "data-order",
}  # fmt: skip
HOSTILE = "<script>alert(1)</script>\"' onmouseover=alert(2) {{7*7}}"


def entry(
    planner: str = "team-a",
    perception: str = "moondream2",
    skill: float = 0.5,
    *,
    evaluated: Evaluated = "self-reported",
    tasks: tuple[TaskFacts, ...] = FACTS,
    **extra: Any,
) -> LeaderboardEntry:
    """Return an entry with invented trials."""
    run = evaluation(planner, perception, tasks, skill, broken_share=extra.pop("broken_share", 0.0), **extra)
    header, lines = submission_lines(run)
    task_set = TaskSet("private.jsonl", (), {fact.id: fact for fact in tasks})
    return LeaderboardEntry(f"{planner}.jsonl", header, tuple(lines), Provenance(evaluated), task_set)


def column(table: Any, name: str) -> list[Any]:
    index = [column.name for column in table.columns].index(name)
    return [cell_value(row[index]) for row in table.rows]


def test_entries_are_ranked_by_accuracy_and_the_baseline_is_not() -> None:
    entries = [entry("weak", skill=0.1), entry("strong", skill=0.95), entry("grammar", skill=0.6)]
    (table,) = leaderboard_tables(entries)
    placed = dict(zip(column(table, "name"), column(table, "rank"), strict=True))
    assert placed == {"strong": 1, "weak": 2, "grammar": BASELINE}
    assert column(table, "name")[0] == "strong"
    accuracy = column(table, "accuracy")[0]
    assert accuracy.low < accuracy.value <= accuracy.high


@given(st.lists(st.tuples(st.sampled_from([0.0, 0.5, 1.0]), st.booleans()), min_size=1, max_size=8))
def test_equal_accuracies_share_a_rank(rows: list[tuple[float, bool]]) -> None:
    by_skill = {skill: entry("team", skill=-9.0 if skill == 0 else 9.0 if skill == 1 else 0.5) for skill in (0.0, 0.5, 1.0)}
    baseline = {skill: entry("grammar", skill=-9.0 if skill == 0 else 9.0 if skill == 1 else 0.5) for skill in (0.0, 0.5, 1.0)}
    placed = rank_entries([(baseline if is_baseline else by_skill)[skill] for skill, is_baseline in rows])
    values = [each.accuracy.value for rank, each in placed if rank is not None and each.accuracy is not None]
    found = [rank for rank, _ in placed if rank is not None]
    assert found == [1 + sum(other > value for other in values) for value in values]
    assert sum(rank is None for rank, _ in placed) == sum(is_baseline for _, is_baseline in rows)


def test_different_tasks_datasets_repeats_and_perception_are_not_mixed() -> None:
    other_dataset = tuple(fact.model_copy(update={"dataset": "scope2"}) for fact in FACTS)
    tables = leaderboard_tables(
        [
            entry("a"), entry("b"), entry("c", tasks=FACTS[:-1]), entry("d", tasks=other_dataset, dataset="scope2"),
            entry("e", perception="ground-truth"), entry("f", epochs=2),
        ]
    )  # fmt: skip
    assert sorted(sorted(column(table, "name")) for table in tables) == [["a", "b"], ["c"], ["d"], ["e"], ["f"]]


def test_labels_and_broken_runs() -> None:
    entries = [entry("hosted-team", evaluated="hosted", skill=0.9), entry("own", broken_share=0.2)]
    (table,) = leaderboard_tables(entries)
    labels = dict(zip(column(table, "name"), column(table, "label"), strict=True))
    assert labels == {"hosted-team": "hosted", "own": "self-reported"}
    assert dict(zip(column(table, "name"), column(table, "rank"), strict=True))["own"] == "not ranked"


def test_text_of_submissions_is_escaped() -> None:
    entries = [entry(HOSTILE, variant=HOSTILE, dataset=HOSTILE)]
    page = leaderboard_html(leaderboard_tables(entries), [RefusedSubmission(HOSTILE, HOSTILE * 100)], "title")
    assert "<script>alert" not in page
    assert {attribute for tag in _tags(page) for attribute in tag} <= ATTRIBUTES
    assert "49" not in re.findall(r"\{\{.*?\}\}", page)
    assert page.count("<script>") == 1


def _tags(page: str) -> list[list[str]]:
    """Return the names of the attributes of each tag."""
    found: list[list[str]] = []

    class Reader(HTMLParser):
        def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
            found.append([name for name, _ in attributes])

    Reader().feed(page)
    return found


def test_the_page_loads_nothing_and_allows_only_its_own_script() -> None:
    import base64
    import hashlib

    page = leaderboard_html(leaderboard_tables([entry()]), [], "Private yard")
    assert not re.search(r"""(?:src|href)=|url\(|@import|https?:""", page)
    (script,) = re.findall(r"<script>(.*?)</script>", page, flags=re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src &#39;sha256-{digest}&#39;" in page or f"script-src 'sha256-{digest}'" in page
    assert "<title>Private yard</title>" in page


def test_an_empty_leaderboard_and_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    assert "no valid submissions" in leaderboard_html([], [], "title")
    (tmp_path / "file").write_text("", "utf-8")
    with pytest.raises(OutputError, match="cannot be written"):
        write_leaderboard([], [], tmp_path / "file" / "page.html")
