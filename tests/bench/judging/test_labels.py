"""Human labels: storage, hidden verdicts, and a complete labelling session on a real log."""

from __future__ import annotations

import gc
import json
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from scope_ptz.bench.judging.human_labels import add_label, labels_file, read_labels, with_labels
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Label
from scope_ptz.bench.tasks.expected import ActionOnly
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.bench.tasks.task import Behaviour, FinalPose, Forbidden, ProgramCall, Task
from scope_ptz.cli import main
from scope_ptz.cli.app import app
from scope_ptz.cli.bench.label import folder_name, write_pictures
from scope_ptz.errors import InputError, OutputError
from tests.bench.judging.test_agreement import evaluation, trial

ANN = Label(by="ann", verdict="incorrect", error_mode=ErrorMode.SCOPE, note="swept nothing\nat all")


def test_the_newest_label_of_each_person_counts(tmp_path: Path) -> None:
    path = labels_file(tmp_path / "a.eval")
    assert read_labels(path) == ()
    add_label(path, ANN, "t#1")
    add_label(path, Label(by="bob", verdict="correct"), "t#1")
    add_label(path, Label(by="ann", verdict="unclear"), "t#1")
    assert [(row.by, row.verdict) for row in read_labels(path)] == [("ann", "unclear"), ("bob", "correct")]
    assert len(path.read_text().splitlines()) == 3, "labels must be appended"


def test_an_incomplete_line_is_removed_by_the_next_label(tmp_path: Path) -> None:
    path = tmp_path / "a.labels.jsonl"
    add_label(path, ANN, "t#1")
    with path.open("a") as file:
        file.write('{"sample": "t#2", "by": "an')
    assert len(read_labels(path)) == 1
    add_label(path, ANN, "t#3")
    assert [row.sample for row in read_labels(path)] == ["t#1", "t#3"]


def test_damage_is_reported_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "a.labels.jsonl"
    add_label(path, ANN, "t#1")
    with path.open("a") as file:
        file.write('{"sample": 7}\n')
    with pytest.raises(InputError, match="line 2 is not a valid label"):
        read_labels(path)
    with pytest.raises(OutputError):
        add_label(tmp_path, ANN, "t#1")


def test_labels_find_their_runs(tmp_path: Path) -> None:
    path = tmp_path / "x.labels.jsonl"
    add_label(path, ANN, "scope1-test-001#1")
    add_label(path, ANN, "gone#1")
    one, two = with_labels(evaluation(trial(1, "correct"), trial(2, "correct")), read_labels(path)).trials
    assert one.labels == (ANN,)
    assert two.labels == ()


def turn_task(number: int, degrees: float) -> Task:
    """Return a task of a bundled scene that the grammar planner solves."""
    return Task(
        id=f"scope1-highway-works-single-call-{number:03d}", dataset="scope1", scene="highway-works", preset="overview",
        instruction=f"Pan right {degrees:g} degrees.", category="single_call", scope="current", difficulty="easy",
        expected=ActionOnly(),
        behaviour=Behaviour(
            final=FinalPose(viewpoint="mast", pan_deg=8 + degrees, tilt_deg=-10, zoom=1.0), forbidden=Forbidden(changes=("zoom",))
        ),
        reference=(ProgramCall(tool="adjust_ptz", arguments={"pan_deg": degrees}),), needs=("move",),
    )  # fmt: skip


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a real log of two runs."""
    folder = tmp_path_factory.mktemp("log")
    dump_tasks([turn_task(1, 20), turn_task(2, 30)], folder / "tasks.jsonl")
    with pytest.MonkeyPatch.context() as patch, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the engine leaves streams to the garbage collector
        patch.setattr("sys.argv", ["scope", "bench", "run", "--tasks", str(folder / "tasks.jsonl"), "--out", str(folder / "logs")])
        with pytest.raises(SystemExit) as excinfo:
            main()
        gc.collect()
    assert not excinfo.value.code
    (path,) = (folder / "logs").glob("**/*.eval")
    return path


@pytest.fixture
def unlabelled_log(log: Path) -> Iterator[Path]:
    yield log
    labels_file(log).unlink(missing_ok=True)


def label(log: Path, typed_text: str, *options: str) -> Result:
    """Run a labelling session. All sessions share one folder of pictures."""
    pictures = () if "--pictures" in options else ("--pictures", str(log.parent / "pictures"))
    return CliRunner().invoke(app, ["bench", "label", str(log), *pictures, *options], input=typed_text)


def test_a_session_is_blind_keeps_all_labels_and_can_be_resumed(unlabelled_log: Path) -> None:
    first = label(unlabelled_log, "?\nc9\nhello\nc fine\n", "--by", "ann")
    assert first.exit_code == 0, first.output
    assert "| Pan right" in first.output
    assert "every check passed" not in first.output, "the results of the checks must be hidden"
    assert "1 of 2 runs labelled by ann" in first.output
    pictures = [Path(line.removeprefix("picture: ")) for line in first.output.splitlines() if line.startswith("picture: ")]
    assert [path.name for path in pictures[:2]] == ["filmstrip.png", "001-view.jpg"]
    assert all(path.stat().st_size > 1000 for path in pictures)
    second = label(unlabelled_log, "i\ni8 it was late\n", "--by", "ann")
    assert "Give an error mode, for example i6:" in second.output
    assert "2 of 2 runs labelled by ann" in second.output
    rows = read_labels(labels_file(unlabelled_log))
    assert {(row.verdict, row.error_mode, row.note) for row in rows} == {
        ("correct", None, "fine"),
        ("incorrect", ErrorMode.REASONING, "it was late"),
    }
    assert label(unlabelled_log, "", "--by", "ann").output.startswith("2 of 2")


def test_a_log_cannot_write_outside_its_folder(tmp_path: Path) -> None:
    class Files:
        references = dict.fromkeys(("../up.jpg", "/x.jpg", "frames/../../up.jpg", "frames/.hidden/x.jpg", "frames/x.sh"), "")
        trace = None

        def picture(self, name: str) -> bytes:
            raise AssertionError(name)

    assert write_pictures(Files(), tmp_path / "deep") == []  # type: ignore[arg-type]
    name = folder_name(tmp_path / "a.eval", "../../etc/pass wd#1")
    assert name.startswith("etc-pass-wd-1-")
    assert "/" not in name
    assert folder_name(tmp_path / "b.eval", "t#1") != folder_name(tmp_path / "a.eval", "t#1")


def test_back_skip_and_quit(unlabelled_log: Path) -> None:
    result = label(unlabelled_log, "b\nu\nb\nc\ns\nq\n", "--by", "bob")
    assert "This is the first run." in result.output
    assert [(row.verdict, row.by) for row in read_labels(labels_file(unlabelled_log))] == [("correct", "bob")]
    assert len(labels_file(unlabelled_log).read_text().splitlines()) == 2


def test_labellers_do_not_see_each_others_progress(unlabelled_log: Path) -> None:
    label(unlabelled_log, "c\nc\n", "--by", "ann")
    assert "0 of 2 runs labelled by bob" in label(unlabelled_log, "q\n", "--by", "bob").output
    assert "0 of 1 runs labelled by bob" in label(unlabelled_log, "q\n", "--by", "bob", "--sample", "1").output


@pytest.mark.full
def test_labels_are_compared_with_the_checks(unlabelled_log: Path) -> None:
    empty = label(unlabelled_log, "", "--compare")
    assert empty.exit_code == 2
    assert "has no labels yet" in empty.output
    label(unlabelled_log, "c\ni3\n", "--by", "ann")
    result = label(unlabelled_log, "", "--compare")
    assert "the checks  against  ann" in result.output
    assert "2 runs, agree on 50.0%" in result.output
    content = json.loads(CliRunner().invoke(app, ["bench", "agree", str(unlabelled_log), "--json"]).output)
    assert content["pairs"][0]["verdicts"]["raw"] == 0.5


@pytest.mark.parametrize(
    ("options", "message"), [((), "--by"), (("--by", "  "), "--by"), (("--compare", "--json"), "has no labels yet")]
)
def test_wrong_options_are_reported(unlabelled_log: Path, options: tuple[str, ...], message: str) -> None:
    result = label(unlabelled_log, "", *options)
    assert result.exit_code == 2
    assert message in result.output


def test_a_missing_log(tmp_path: Path) -> None:
    for command in (["label", "--by", "x"], ["agree"]):
        result = CliRunner().invoke(app, ["bench", *command, str(tmp_path / "none.eval")])
        assert result.exit_code == 2
        assert "does not exist" in result.output
