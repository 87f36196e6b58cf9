"""``scope bench label``: a person judges runs, without seeing what checks and judges said."""

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

from scope_ptz.cli.bench_agree import AsJson, agreement_lines, raters_in
from scope_ptz.cli.endings import ending, put, put_json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scope_ptz.bench.engine.logs import SampleFiles
    from scope_ptz.bench.scoring.trials import Evaluation, Label, Trial

_HELP = """c correct   i1-i8 incorrect, with the error mode   u unclear   s skip   b back   q quit   ? modes
A note may follow: "i6 the tool counted 4, there are 5"."""
_COMMAND = re.compile(r"\A(?P<verb>[ciusbq?])(?P<mode>[1-8])?(?:\s+(?P<note>.*))?\Z", re.IGNORECASE | re.DOTALL)
_PICTURE = re.compile(r"\A(?:frames|pictures)/[\w.-]+\.(?:jpg|png)\Z")
"""Names of pictures as run folders make them: what a log claims becomes no other path."""

_CHARS = 40_000


def label(
    log: Annotated[Path, typer.Argument(help="A log of scope bench run.")],
    by: Annotated[str, typer.Option("--by", help="Who labels: your name or initials. Each person's labels stand apart.")] = "",
    sample: Annotated[int | None, typer.Option(min=1, help="Label only so many runs, drawn at random.")] = None,
    seed: Annotated[int, typer.Option(help="Of the order in which runs are shown.")] = 1,
    pictures: Annotated[Path | None, typer.Option(help="Folder for the pictures of runs (default: a temporary one).")] = None,
    compare: Annotated[
        bool, typer.Option("--compare", help="Label nothing; print how far labels agree with checks and judges.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Label runs by hand: correct, incorrect with an error mode, or unclear. Labels stand beside the log; go on at any time."""
    with ending(as_json=as_json):
        if compare:
            _compare(log, as_json=as_json)
            return
        from scope_ptz.bench.engine.logs import read_evaluation
        from scope_ptz.errors import InputError

        if not by.strip():
            raise InputError("Say who labels, with --by NAME.")
        evaluation = read_evaluation(log)
        trials = drawn(evaluation, sample, seed)
        if pictures is not None:
            _Labelling(log, by.strip(), trials, pictures).run()
            return
        with tempfile.TemporaryDirectory(prefix="scope-label-") as folder:
            _Labelling(log, by.strip(), trials, Path(folder)).run()


def drawn(evaluation: Evaluation, number: int | None, seed: int) -> list[Trial]:
    """The runs to label, in an order that says nothing about them. Those that never began cannot be labelled, and those that
    infrastructure broke are made again, which no label outlives."""
    fit = (trial for trial in evaluation.trials if trial.outcome is not None and trial.headline != "infrastructure")
    trials = sorted(fit, key=lambda trial: trial.sample)
    random.Random(seed).shuffle(trials)
    return trials[:number]


def _compare(log: Path, *, as_json: bool) -> None:
    from scope_ptz.bench.judging.agreement import measure_agreement
    from scope_ptz.errors import InputError

    raters = raters_in([log])
    people = {rater.name for rater in raters if rater.kind == "person"}
    if not people:
        raise InputError(f"Nobody has labelled runs of {log} yet. Label some with 'scope bench label {log} --by NAME'.")
    report = measure_agreement(raters)
    report = replace(report, pairs=tuple(pair for pair in report.pairs if {pair.first, pair.second} & people))
    if as_json:
        put_json(report.as_dict(), indent=1)
        return
    for line in agreement_lines(report):
        put(line)


class _Labelling:
    """One sitting: runs one after the other, until all are labelled, or the person or the input ends it."""

    def __init__(self, log: Path, by: str, trials: Sequence[Trial], pictures: Path) -> None:
        from scope_ptz.bench.judging.human_labels import labels_file, read_labels

        self.log, self.by, self.trials, self.pictures = log, by, trials, pictures
        self.file = labels_file(log)
        self.done = {row.sample for row in read_labels(self.file) if row.by == by}

    def run(self) -> None:
        at, first = 0, True
        while at < len(self.trials):
            trial = self.trials[at]
            if trial.sample in self.done:
                at += 1
                continue
            if first:
                put(_HELP)
                first = False
            self._show(trial)
            step = self._ask(trial)
            if step is None:
                break
            at = max(0, at + step)
        left = sum(trial.sample not in self.done for trial in self.trials)
        put(f"{len(self.trials) - left} of {len(self.trials)} runs labelled by {self.by}, in {self.file}")

    def _show(self, trial: Trial) -> None:
        from scope_ptz.bench.engine.logs import open_sample
        from scope_ptz.bench.judging.case import case_of
        from scope_ptz.bench.judging.rendering import render

        number = sum(other.sample in self.done for other in self.trials) + 1
        files = open_sample(self.log, trial.sample)
        put(f"\n{'=' * 20} run {number} of {len(self.trials)} {'=' * 20}")
        put(render(trial.task, case_of(files.trace, files.places), _CHARS))
        for path in kept_pictures(files, self.pictures / folder_name(self.log, trial.sample)):
            put(f"picture: {path}")

    def _ask(self, trial: Trial) -> int | None:
        """Wait for a command about a run. How far to go on; None to end."""
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
                    return self._back(trial)
                case "?":
                    _put_modes()
                case verb:
                    made = self._label(verb, command["mode"], (command["note"] or "").strip())
                    if made is not None:
                        self._keep(trial, made)
                        return 1

    def _label(self, verb: str, mode: str | None, note: str) -> Label | None:
        from scope_ptz.bench.scoring.error_modes import ErrorMode
        from scope_ptz.bench.scoring.trials import Label

        if verb == "i" and mode is None:
            put("Which error mode?")
            _put_modes()
            return None
        if verb == "i":
            return Label(by=self.by, verdict="incorrect", error_mode=list(ErrorMode)[int(mode or 0) - 1], note=note)
        return Label(by=self.by, verdict="correct" if verb == "c" else "unclear", note=note)

    def _keep(self, trial: Trial, made: Label) -> None:
        from scope_ptz.bench.judging.human_labels import add_label

        add_label(self.file, made, trial.sample)
        self.done.add(trial.sample)

    def _back(self, trial: Trial) -> int:
        """To the run before, whose label is asked for again."""
        at = self.trials.index(trial)
        if at == 0:
            put("This is the first run.")
            return 0
        self.done.discard(self.trials[at - 1].sample)
        return -1


def _put_modes() -> None:
    from scope_ptz.bench.judging.rubrics import mode_lines

    for line in mode_lines():
        put(f"  i{line}")


def folder_name(log: Path, sample: str) -> str:
    """A folder of its own for every run of every log, whatever these are called."""
    words = re.sub(r"[^a-z0-9]+", "-", sample.lower()).strip("-")[:60]
    digest = hashlib.sha256(f"{log.resolve()} {sample}".encode()).hexdigest()
    return f"{words}-{digest[:8]}"


def kept_pictures(files: SampleFiles, folder: Path) -> list[Path]:
    """A run's pictures written into a folder, the filmstrip first. Names that no run folder would make are left out.

    What was written at an earlier sitting is not written again.
    """
    from scope_ptz.agent.filmstrip import write_filmstrip
    from scope_ptz.errors import OutputError, ScopeError

    written = list[Path]()
    try:
        for name in files.references:
            path = folder / name
            data = files.picture(name) if _PICTURE.match(name) and not path.is_file() else None
            if data is not None:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
            if _PICTURE.match(name) and path.is_file():
                written.append(path)
    except OSError as error:
        raise OutputError(f"{folder} cannot be written: {error.strerror}. Choose another folder with --pictures.") from error
    strip = folder / "filmstrip.png"
    if written and not strip.is_file():
        with suppress(ScopeError):  # A picture that is missing or damaged; the others are there to be looked at.
            write_filmstrip(replace(files.trace, folder=folder))
    return [*([strip] if strip.is_file() else []), *written]
