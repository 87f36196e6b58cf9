"""The judgement journal of a log: a file next to the log that stores new judgements until they are written to the log.

An interrupted rescoring therefore loses no judgements.
"""

from __future__ import annotations

import json
from pathlib import Path

from pydantic import ValidationError

from scope_ptz.bench.judging.json_lines import append_line, complete_lines
from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.scoring.trials import Judgement
from scope_ptz.errors import TraceError


def journal_file(log: Path) -> Path:
    """Return the path of a log's journal."""
    return log.with_suffix(".judgements.jsonl")


class Journal:
    """The judgements of the runs in a log, by sample, judge and repeat.

    Attributes:
        path: Path of the journal file; None for a journal in memory.
        added: The judgements that were added since this object was created.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.path = path
        self.added: list[Judgement] = []
        self._judgements: dict[tuple[str, str, int], Judgement] = {}
        self._unlogged: dict[tuple[str, str, int], Judgement] = {}
        for number, line in complete_lines(path) if path is not None else ():
            try:
                row = json.loads(line)
                judgement = Judgement.model_validate(row["judgement"])
                key = (row["sample"], judgement.judge, judgement.repeat)
                self._judgements[key] = self._unlogged[key] = judgement
            except (ValueError, KeyError, TypeError, ValidationError) as error:
                raise TraceError(
                    f"{path}, line {number} is not a valid judgement ({error}). Remove the line or the file."
                ) from error

    @classmethod
    def of_log(cls, log: Path) -> Journal:
        """Open the journal of a log."""
        return cls(journal_file(log))

    def find(self, sample: str, judge: str, repeat: int) -> Judgement | None:
        """Return the judgement with the current prompt; None if there is no such judgement or it failed.

        The caller must write the returned judgement to the log, because ``remove_logged`` removes it from the file.
        """
        judgement = self._judgements.get((sample, judge, repeat))
        if judgement is None or judgement.prompt != prompt_version() or judgement.verdict == "failed":
            return None
        self._unlogged.pop((sample, judge, repeat), None)
        return judgement

    def register_logged(self, sample: str, judgement: Judgement) -> None:
        """Register a judgement that the log already contains."""
        key = (sample, judgement.judge, judgement.repeat)
        self._judgements.setdefault(key, judgement)
        if self._unlogged.get(key) == judgement:
            del self._unlogged[key]

    def add(self, sample: str, judgement: Judgement) -> None:
        """Add a new judgement, and append it to the file."""
        key = (sample, judgement.judge, judgement.repeat)
        self._judgements[key] = judgement
        self._unlogged.pop(key, None)
        self.added.append(judgement)
        if self.path is not None:
            append_line(self.path, _line(sample, judgement))

    def remove_logged(self) -> None:
        """Remove the judgements that the log now contains from the file. Judgements from other interrupted rescorings remain."""
        if self.path is None:
            return
        lines = [_line(sample, judgement) for (sample, _, _), judgement in self._unlogged.items() if judgement.verdict != "failed"]
        if lines:
            new_file = self.path.with_name(f"{self.path.name}.new")
            new_file.write_text("".join(line + "\n" for line in lines), "utf-8")
            new_file.replace(self.path)
        else:
            self.path.unlink(missing_ok=True)


def _line(sample: str, judgement: Judgement) -> str:
    return json.dumps({"sample": sample, "judgement": judgement.model_dump(mode="json")}, ensure_ascii=False)
