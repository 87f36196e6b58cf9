"""``scope bench label``: label runs by hand, without seeing the verdicts of checks and judges."""

from __future__ import annotations

import hashlib
import random
import re
import sys
import tempfile
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench.judge import raters_in
from scope_ptz.cli.exit import put, put_json
from scope_ptz.cli.options import JsonOption

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scope_ptz.bench.engine.sample_files import SampleFiles
    from scope_ptz.bench.scoring.trials import Evaluation, Label, Trial

_HELP = """c correct   i1-i8 incorrect, with the error mode   u unclear   s skip   b back   q quit   ? modes
You can add a note: "i6 the tool counted 4, there are 5"."""
_COMMAND = re.compile(r"\A(?P<verb>[ciusbq?])(?P<mode>[1-8])?(?:\s+(?P<note>.*))?\Z", re.IGNORECASE | re.DOTALL)
_PICTURE = re.compile(r"\A(?:frames|pictures)/[\w.-]+\.(?:jpg|png)\Z")
"""Valid picture names in run folders. Other names are skipped, so that a log cannot cause writes to other paths."""

MAX_RUN_CHARS = 40_000
"""Maximum number of characters to print for a run. Longer descriptions are shortened."""


def label(
    log: Annotated[Path, typer.Argument(help="Log of 'scope bench run'.")],
    by: Annotated[str, typer.Option("--by", help="Your name or initials. Each person's labels are kept separately.")] = "",
    sample: Annotated[int | None, typer.Option(min=1, help="Label only N runs, sampled at random.")] = None,
    seed: Annotated[int, typer.Option(help="Seed for the order in which runs are shown.")] = 1,
    pictures: Annotated[Path | None, typer.Option(help="Folder for the pictures of runs (default: a temporary one).")] = None,
    compare: Annotated[
        bool, typer.Option("--compare", help="Only print the agreement between the labels and the checks and judges.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Label runs by hand: correct, incorrect with an error mode, or unclear. Labels are saved next to the log.

    You can quit and resume at any time.
    """
    from scope_ptz.errors import InputError

    if compare:
        _compare(log, as_json=as_json)
        return
    from scope_ptz.bench.engine.logs import read_evaluation

    if not by.strip():
        raise InputError("Give your name or initials with --by NAME.")
    trials = sample_trials(read_evaluation(log), sample, seed)
    if pictures is not None:
        _LabelSession(log, by.strip(), trials, pictures).run()
        return
    with tempfile.TemporaryDirectory(prefix="scope-label-") as folder:
        _LabelSession(log, by.strip(), trials, Path(folder)).run()


def sample_trials(evaluation: Evaluation, number: int | None, seed: int) -> list[Trial]:
    """Return the runs to label, in random order.

    Runs that never started are excluded. Runs with an infrastructure failure are also excluded, because resuming the evaluation
    replaces them.
    """
    labelable = (trial for trial in evaluation.trials if trial.outcome is not None and trial.headline != "infrastructure")
    trials = sorted(labelable, key=lambda trial: trial.sample)
    random.Random(seed).shuffle(trials)
    return trials[:number]


def _compare(log: Path, *, as_json: bool) -> None:
    from scope_ptz.bench.judging.agreement import measure_agreement
    from scope_ptz.bench.judging.agreement_text import agreement_lines
    from scope_ptz.errors import InputError

    raters = raters_in([log])
    labellers = {rater.name for rater in raters if rater.kind == "person"}
    if not labellers:
        raise InputError(f"{log} has no labels yet. Label some runs with 'scope bench label {log} --by NAME'.")
    report = measure_agreement(raters)
    report = replace(report, pairs=tuple(pair for pair in report.pairs if {pair.first, pair.second} & labellers))
    if as_json:
        put_json(report.as_dict(), indent=1)
        return
    for line in agreement_lines(report):
        put(line)


class _LabelSession:
    """A labelling session, which shows runs one by one until all are labelled, the user quits, or the input ends."""

    def __init__(self, log: Path, by: str, trials: Sequence[Trial], pictures: Path) -> None:
        from scope_ptz.bench.judging.human_labels import labels_file, read_labels

        self.log, self.by, self.trials, self.pictures = log, by, trials, pictures
        self.file = labels_file(log)
        self.labelled = {row.sample for row in read_labels(self.file) if row.by == by}

    def run(self) -> None:
        index, first = 0, True
        while index < len(self.trials):
            trial = self.trials[index]
            if trial.sample in self.labelled:
                index += 1
                continue
            if first:
                put(_HELP)
                first = False
            self._show(trial)
            step = self._ask(trial)
            if step is None:
                break
            index = max(0, index + step)
        unlabelled = sum(trial.sample not in self.labelled for trial in self.trials)
        put(f"{len(self.trials) - unlabelled} of {len(self.trials)} runs labelled by {self.by}, in {self.file}")

    def _show(self, trial: Trial) -> None:
        from scope_ptz.bench.engine.sample_files import open_sample
        from scope_ptz.bench.judging.case import case_of
        from scope_ptz.bench.judging.rendering import describe_run

        number = sum(other.sample in self.labelled for other in self.trials) + 1
        files = open_sample(self.log, trial.sample)
        put(f"\n{'=' * 20} run {number} of {len(self.trials)} {'=' * 20}")
        put(describe_run(trial.task, case_of(files.trace, files.places), MAX_RUN_CHARS))
        for path in write_pictures(files, self.pictures / folder_name(self.log, trial.sample)):
            put(f"picture: {path}")

    def _ask(self, trial: Trial) -> int | None:
        """Ask for a command about a run. Return how many runs to move forward, or None to end the session."""
        while True:
            sys.stdout.write("label> ")
            sys.stdout.flush()
            line = sys.stdin.readline()
            if not line:
                put("")
                return None
            command = _COMMAND.match(line.strip())
            if command is None or (command["mode"] and command["verb"].lower() != "i"):
                put(_HELP)
                continue
            match command["verb"].lower():
                case "q":
                    return None
                case "s":
                    return 1
                case "b":
                    return self._go_back(trial)
                case "?":
                    _print_modes()
                case verb:
                    new_label = self._make_label(verb, command["mode"], (command["note"] or "").strip())
                    if new_label is not None:
                        self._save_label(trial, new_label)
                        return 1

    def _make_label(self, verb: str, mode: str | None, note: str) -> Label | None:
        from scope_ptz.bench.scoring.error_modes import ErrorMode
        from scope_ptz.bench.scoring.trials import Label

        if verb == "i" and mode is None:
            put("Give an error mode, for example i6:")
            _print_modes()
            return None
        if verb == "i":
            return Label(by=self.by, verdict="incorrect", error_mode=list(ErrorMode)[int(mode or 0) - 1], note=note)
        return Label(by=self.by, verdict="correct" if verb == "c" else "unclear", note=note)

    def _save_label(self, trial: Trial, new_label: Label) -> None:
        from scope_ptz.bench.judging.human_labels import add_label

        add_label(self.file, new_label, trial.sample)
        self.labelled.add(trial.sample)

    def _go_back(self, trial: Trial) -> int:
        """Move back to the previous run, and ask for its label again."""
        index = self.trials.index(trial)
        if index == 0:
            put("This is the first run.")
            return 0
        self.labelled.discard(self.trials[index - 1].sample)
        return -1


def _print_modes() -> None:
    from scope_ptz.bench.judging.rubrics import mode_lines

    for line in mode_lines():
        put(f"  i{line}")


def folder_name(log: Path, sample: str) -> str:
    """Return a folder name that is unique for each run of each log."""
    words = re.sub(r"[^a-z0-9]+", "-", sample.lower()).strip("-")[:60]
    digest = hashlib.sha256(f"{log.resolve()} {sample}".encode()).hexdigest()
    return f"{words}-{digest[:8]}"


def write_pictures(files: SampleFiles, folder: Path) -> list[Path]:
    """Write a run's pictures to a folder, and return their paths, the filmstrip first.

    Pictures that already exist are not written again, and pictures with invalid names are skipped.
    """
    from scope_ptz.agent.filmstrip import write_filmstrip
    from scope_ptz.errors import OutputError, ScopeError

    paths = list[Path]()
    try:
        for name in files.references:
            path = folder / name
            data = files.picture(name) if _PICTURE.match(name) and not path.is_file() else None
            if data is not None:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
            if _PICTURE.match(name) and path.is_file():
                paths.append(path)
    except OSError as error:
        raise OutputError(f"{folder} cannot be written to: {error.strerror}. Choose another folder with --pictures.") from error
    filmstrip = folder / "filmstrip.png"
    if paths and not filmstrip.is_file():
        with suppress(ScopeError):  # One picture is missing or damaged; the others are still shown.
            write_filmstrip(replace(files.trace, folder=folder))
    return [*([filmstrip] if filmstrip.is_file() else []), *paths]
