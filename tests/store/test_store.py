"""Indexing, lists, filters, feedback, conversations, audit logs, retention and export."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.agent.trace import read_trace
from scope_ptz.camera.guard.audit import AuditLog
from scope_ptz.errors import InputError, OutputError, UnknownNameError
from scope_ptz.store.audit_index import index_audit_log, list_audit
from scope_ptz.store.conversations import (
    add_conversation,
    list_conversations,
    load_conversation,
    remove_conversation,
    runs_of_conversation,
    touch_conversation,
)
from scope_ptz.store.feedback import add_feedback, feedback_on, remove_feedback
from scope_ptz.store.matching import has_words, words_of
from scope_ptz.store.request_file import RunRequest
from scope_ptz.store.retention import Retention, keep
from scope_ptz.store.rows import RunFilter
from scope_ptz.store.run_store import RunStore
from tests.store.conftest import INSTRUCTIONS


def ids(store: RunStore, **conditions: object) -> list[str]:
    return [run.instruction for run in store.runs(RunFilter.model_validate(conditions)).runs]


def newest(store: RunStore) -> str:
    return store.runs(limit=1).runs[0].id


def test_run_folders_are_indexed_but_not_changed(root: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in root.rglob("*")}
    with RunStore(root) as store:
        report = store.index()
    assert (report.added, report.updated, report.removed, report.damaged) == (3, 0, 0, {})
    assert {path: path.stat().st_mtime_ns for path in root.rglob("*") if not path.name.startswith("store.sqlite")} == before


def test_a_stored_run_matches_its_trace(store: RunStore) -> None:
    assert sorted(ids(store)) == sorted(INSTRUCTIONS)
    (row,) = store.runs(RunFilter(text="picture")).runs
    stored, trace = store.run(row.id), read_trace(store.folder(row.id))
    assert trace.ended is not None
    assert (row.answer, row.outcome, row.camera) == (trace.ended.text, "answered", "analytic-yard")
    assert row.total_s == trace.ended.timings.total_s
    assert row.ended is not None and row.started < row.ended
    assert [step.tool for step in stored.steps] == ["adjust_ptz", "take_image"]
    assert stored.steps[0].arguments == {"pan_deg": 20.0}
    assert stored.steps[0].pan_deg == trace.calls[0].pose.pan_deg
    assert {frame.name for frame in stored.frames} == {
        path.relative_to(store.folder(row.id)).as_posix()
        for part in ("frames", "pictures")
        for path in (store.folder(row.id) / part).iterdir()
    }


def test_indexing_again_adds_only_what_is_new(store: RunStore, copies: Callable[[int], list[str]]) -> None:
    assert store.index().added == 0
    copies(2)
    report = store.index()
    assert (report.added, report.updated) == (2, 0)
    assert store.count() == 5


def test_an_unfinished_run_is_listed_and_updated_when_it_continues(store: RunStore, copies: Callable[[int], list[str]]) -> None:
    (name,) = copies(1)
    trace = store.root / name / "trace.jsonl"
    lines = trace.read_text().splitlines(keepends=True)
    trace.write_text("".join(lines[:-2]) + lines[-2][:20])  # a line that was cut off
    store.index()
    row = store.run(name).run
    assert (row.outcome, row.ended, row.calls) == ("unfinished", None, 1)
    assert row.total_s > 0
    trace.write_text("".join(lines))
    assert store.index().updated == 1
    assert store.run(name).run.outcome == "answered"


def test_a_damaged_folder_is_reported_and_others_are_indexed(root: Path, copies: Callable[[int], list[str]]) -> None:
    damaged, newer = copies(2)
    (root / damaged / "trace.jsonl").write_text("{]\n")
    first = (root / newer / "trace.jsonl").read_text().replace('"format":1', '"format":99', 1)
    (root / newer / "trace.jsonl").write_text(first)
    (root / "notes").mkdir()
    with RunStore(root) as store:
        report = store.index()
        assert report.added == 3
    assert set(report.damaged) == {damaged, newer}
    assert "line 1 is damaged" in report.damaged[damaged]
    assert "newer scope-ptz" in report.damaged[newer]


def test_runs_without_a_folder_are_removed_unless_they_have_feedback(store: RunStore, copies: Callable[[int], list[str]]) -> None:
    plain, rated = copies(2)
    store.index()
    add_feedback(store.database, rated, 1)
    for name in (plain, rated):
        (store.root / name).rename(store.root.parent / name)
    report = store.index()
    assert (report.removed, report.missing) == (1, 1)
    assert feedback_on(store.database, rated)[0].rating == 1
    with pytest.raises(UnknownNameError):
        store.run(plain)


def test_requests_survive_the_loss_of_the_database(root: Path) -> None:
    folder = sorted(root.iterdir())[0]
    RunRequest(kind="tool", camera="yard-gate", conversation="c1", actor="anna").write(folder)
    with RunStore(root) as store:
        store.index()
        row = store.run(folder.name).run
    assert (row.kind, row.camera, row.conversation, row.actor) == ("tool", "yard-gate", "c1", "anna")
    (folder / "request.json").write_text('{"kind": "sorcery"}')
    (root / "store.sqlite").unlink()
    with RunStore(root) as store:
        store.index()
        assert store.run(folder.name).run.kind == "instruction"


def test_filters(store: RunStore) -> None:
    assert ids(store, text="picture") == [INSTRUCTIONS[1]]
    assert ids(store, text="COLOUR of")[:1] == []
    assert ids(store, text="colo") == [INSTRUCTIONS[2]]
    assert ids(store, text="sky colo") == [INSTRUCTIONS[2]]
    assert ids(store, text='" OR 1') == []
    assert ids(store, text="*?!") == []
    assert ids(store, tool="take_image") == [INSTRUCTIONS[1]]
    assert ids(store, camera="nowhere") == []
    assert len(ids(store, camera="analytic-yard", planner="grammar", perception="ground-truth", kind="instruction")) == 3
    now = datetime.now(UTC)
    assert len(ids(store, since=now - timedelta(days=1), until=now)) == 3
    assert ids(store, until=now - timedelta(days=1)) == []
    run = newest(store)
    add_feedback(store.database, run, -1)
    assert [row.id for row in store.runs(RunFilter(rating=-1)).runs] == [run]
    assert ids(store, rating=1) == []


def test_pages_contain_every_run_once_and_in_order(store: RunStore, copies: Callable[[int], list[str]]) -> None:
    copies(8)  # with equal times
    store.index()
    seen, after = [], None
    while True:
        page = store.runs(limit=3, after=after)
        seen += page.runs
        after = page.next
        if after is None:
            break
    assert len({run.id for run in seen}) == len(seen) == 11
    assert [run.started for run in seen] == sorted((run.started for run in seen), reverse=True)
    assert store.ids(RunFilter()) == [run.id for run in seen]
    for wrong in ("", "x", "1:y"):
        with pytest.raises(InputError, match="not a cursor"):
            store.runs(after=wrong)
    with pytest.raises(InputError, match="A page must have"):
        store.runs(limit=0)


@given(
    st.lists(st.sampled_from(["Zoom", "cônes", "at", "the", "GATE-2", "straße", "5x", "日本"]), min_size=1, max_size=5),
    st.integers(1, 3),
)
def test_words_are_found_anywhere_in_a_run(words: list[str], cut: int) -> None:
    text = " ".join(words)
    wanted = words_of(text)
    assert has_words(text, "", " ".join(wanted))
    assert has_words("", text.upper() if "ß" not in text else text, " ".join(wanted))
    assert has_words(text, "", wanted[-1][:cut])
    assert not has_words(text, "", f"nowhere {wanted[0]}")


def test_words_that_occur_in_many_runs_are_found(
    store: RunStore, copies: Callable[[int], list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    copies(3)
    store.index()
    expected = {text: ids(store, text=text) for text in ("ball", "balls see", "pan", "colour", "nothing")}
    monkeypatch.setattr("scope_ptz.store.queries._COMMON_WORD_RUNS", 1)
    assert {text: ids(store, text=text) for text in expected} == expected
    assert len(expected["ball"]) >= 4


def test_feedback_replaces_earlier_feedback_of_the_same_person(store: RunStore) -> None:
    run, database = newest(store), store.database
    add_feedback(database, run, 1, "well done", actor="anna")
    second = add_feedback(database, run, -1, "no, wrong", actor="anna")
    add_feedback(database, run, 1, actor="ben", position=0)
    assert [(each.actor, each.rating, each.position) for each in feedback_on(database, run)] == [("anna", -1, None), ("ben", 1, 0)]
    row = store.run(run).run
    assert (row.thumbs_up, row.thumbs_down) == (1, 1)
    with pytest.raises(UnknownNameError):
        remove_feedback(database, second.id, actor="ben")
    remove_feedback(database, second.id, actor="anna")
    assert len(feedback_on(database, run)) == 1
    for wrong in ({"rating": 2}, {"rating": 0}, {"rating": 1, "comment": "x" * 5000}):
        with pytest.raises(InputError):
            add_feedback(database, run, **wrong)
    with pytest.raises(UnknownNameError):
        add_feedback(database, run, 1, position=99)
    with pytest.raises(UnknownNameError):
        add_feedback(database, "nothing", 1)


def test_conversations_belong_to_their_owner(store: RunStore, copies: Callable[[int], list[str]]) -> None:
    database = store.database
    mine = add_conversation(database, camera="yard-gate", pair="grammar+ground-truth", owner="anna", title="cones")
    add_conversation(database, camera="yard-gate", pair="grammar+ground-truth", owner="ben")
    (name,) = copies(1)
    RunRequest(camera="yard-gate", conversation=mine.id, actor="anna").write(store.root / name)
    store.index()
    assert runs_of_conversation(database, mine.id) == [name]
    assert [each.id for each in list_conversations(database, owner="anna")] == [mine.id]
    assert list_conversations(database, owner="anna", camera="other") == []
    touch_conversation(database, mine.id, title="workers")
    assert load_conversation(database, mine.id, owner="anna").title == "workers"
    for act in (load_conversation, remove_conversation):
        with pytest.raises(UnknownNameError):
            act(database, mine.id, owner="ben")
    remove_conversation(database, mine.id, owner="anna")
    assert store.run(name).run.conversation is None


def test_audit_logs_are_indexed_as_they_grow(store: RunStore, tmp_path: Path) -> None:
    path = tmp_path / "audit.jsonl"
    log = AuditLog(path, "yard-gate", "anna")
    log.write("instruction", text="count the cones")
    assert index_audit_log(store.database, path) == 1
    with path.open("ab") as file:
        file.write(b'not an entry\n{"time": "2026')
    assert index_audit_log(store.database, path) == 0
    with path.open("ab") as file:
        file.write(b'-01-01T00:00:00+00:00", "camera": "dock", "actor": "ben", "event": "move"}\n')
    log.write("stop")
    log.close()
    assert index_audit_log(store.database, path) == 2
    assert [row.event for row in list_audit(store.database)] == ["stop", "instruction", "move"]
    (row,) = list_audit(store.database, camera="dock", until=datetime.now(UTC), since=datetime(2025, 1, 1, tzinfo=UTC))
    assert (row.actor, row.details) == ("ben", {})
    path.write_text("")  # log rotation has replaced the file
    assert index_audit_log(store.database, path) == 0
    assert list_audit(store.database) == []
    with pytest.raises(InputError, match="cannot be read"):
        index_audit_log(store.database, tmp_path / "missing.jsonl")


def test_pruning_removes_the_oldest_runs_without_feedback(store: RunStore, copies: Callable[[int], list[str]]) -> None:
    copies(4)
    store.index()
    oldest = store.ids(RunFilter())[::-1]
    keep(store.database, oldest[0])
    add_feedback(store.database, oldest[1], 1)
    pruned = store.prune(Retention(max_runs=2), dry_run=True)
    assert store.count() == 7
    assert store.prune(Retention(max_runs=2)) == pruned
    left = store.ids(RunFilter())
    assert set(left) == {*oldest[-2:], *oldest[:2]}
    assert {path.name for path in store.root.iterdir() if path.is_dir()} == set(left)
    assert pruned.freed_bytes > 0
    assert store.prune(Retention(max_age_s=3600)).runs == []
    keep(store.database, oldest[0], kept=False)
    assert store.prune(Retention(max_bytes=0)).runs == [*oldest[-1:-3:-1], oldest[0]]
    with pytest.raises(InputError):
        Retention()
    with pytest.raises(InputError):
        Retention(max_runs=-1)


def test_pruning_keeps_a_run_that_may_still_be_running(store: RunStore, copies: Callable[[int], list[str]]) -> None:
    (name,) = copies(1)
    trace = store.root / name / "trace.jsonl"
    trace.write_text("".join(trace.read_text().splitlines(keepends=True)[:-1]))
    store.index()
    assert name not in store.prune(Retention(max_runs=0)).runs
    assert (store.root / name).is_dir()


def test_pruning_never_follows_a_link(store: RunStore, tmp_path: Path) -> None:
    run = newest(store)
    elsewhere = tmp_path / "elsewhere"
    (store.root / run).rename(elsewhere)
    (store.root / run).symlink_to(elsewhere)
    assert run not in store.prune(Retention(max_runs=0)).runs
    assert (elsewhere / "trace.jsonl").is_file()


def test_export(store: RunStore, tmp_path: Path) -> None:
    runs = store.ids(RunFilter())
    add_feedback(store.database, runs[0], 1, "good")
    assert store.export(runs, tmp_path / "runs.jsonl", "jsonl") == 3
    lines = [json.loads(line) for line in (tmp_path / "runs.jsonl").read_text().splitlines()]
    assert [line["id"] for line in lines] == runs
    assert lines[0]["feedback"][0]["comment"] == "good"
    assert store.export(runs, tmp_path / "runs.zip", "zip") == 3
    with zipfile.ZipFile(tmp_path / "runs.zip") as archive:
        assert archive.read(f"{runs[0]}/trace.jsonl") == (store.folder(runs[0]) / "trace.jsonl").read_bytes()
    with pytest.raises(InputError, match="no export format"):
        store.export(runs, tmp_path / "x", "pdf")  # type: ignore[arg-type]
    with pytest.raises(UnknownNameError):
        store.export(["nothing"], tmp_path / "runs.jsonl", "jsonl")
    assert len((tmp_path / "runs.jsonl").read_text().splitlines()) == 3, "an export that failed replaces nothing"
    with pytest.raises(OutputError):
        store.export(runs, tmp_path / "missing" / "x", "jsonl")


def test_chat_export_is_a_valid_chat_conversation(store: RunStore, tmp_path: Path) -> None:
    (run,) = store.ids(RunFilter(tool="take_image"))
    store.export([run], tmp_path / "chat.jsonl", "chat")
    line = json.loads((tmp_path / "chat.jsonl").read_text())
    roles = [message["role"] for message in line["messages"]]
    assert roles[:2] == ["system", "user"]
    assert roles[-1] == "assistant"
    calls = [call for message in line["messages"] for call in message.get("tool_calls", ())]
    assert [call["function"]["name"] for call in calls[-2:]] == ["adjust_ptz", "take_image"]
    results = [message["tool_call_id"] for message in line["messages"] if message["role"] == "tool"]
    assert results == [call["id"] for call in calls]
    assert line["messages"][-1]["content"] == store.run(run).run.answer
    assert len(line["tools"]) == 9


@pytest.mark.parametrize("name", ["", ".", "..", "a/b", "a\\b", "../runs", "a\0", "ä"])
def test_a_run_id_never_leaves_the_folder(store: RunStore, name: str) -> None:
    with pytest.raises(UnknownNameError):
        store.folder(name)
