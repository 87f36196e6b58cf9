"""The journal of a log: a file next to it that stores new judgements until the log contains them.

An interrupted rescoring therefore loses no judgement.
"""

from __future__ import annotations

import json
from pathlib import Path

from pydantic import ValidationError

from scope_ptz.bench.judging.json_lines import append_line, whole_lines
from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.scoring.trials import Judgement
from scope_ptz.errors import TraceError


def journal_file(log: Path) -> Path:
    """Return the path of a log's journal."""
    return log.with_suffix(".judgements.jsonl")


class Journal:
    """Judgements by run, judge and index. ``made`` lists the added ones. Without a path, the journal is in memory."""

    def __init__(self, path: Path | None = None) -> None:
        self.path = path
        self.made: list[Judgement] = []
        self._known: dict[tuple[str, str, int], Judgement] = {}
        self._waiting: dict[tuple[str, str, int], Judgement] = {}
        for number, line in whole_lines(path) if path is not None else ():
            try:
                row = json.loads(line)
                made = Judgement.model_validate(row["judgement"])
                self._known[(row["sample"], made.judge, made.repeat)] = made
                self._waiting[(row["sample"], made.judge, made.repeat)] = made
            except (ValueError, KeyError, TypeError, ValidationError) as error:
                raise TraceError(f"{path}, line {number} is not a judgement ({error}). Remove the line or the file.") from error

    @classmethod
    def beside(cls, log: Path) -> Journal:
        """Return the journal of a log."""
        return cls(journal_file(log))

    def find(self, sample: str, judge: str, repeat: int) -> Judgement | None:
        """Return a judgement made with the current prompt; None if there is none or if it failed."""
        made = self._known.get((sample, judge, repeat))
        if made is None or made.prompt != prompt_version() or made.verdict == "failed":
            return None
        self._waiting.pop((sample, judge, repeat), None)
        return made

    def know(self, sample: str, judgement: Judgement) -> None:
        """Register a judgement that the log already contains."""
        key = (sample, judgement.judge, judgement.repeat)
        self._known.setdefault(key, judgement)
        if self._waiting.get(key) == judgement:
            del self._waiting[key]

    def add(self, sample: str, judgement: Judgement) -> None:
        """Add a new judgement, and write it to the file."""
        key = (sample, judgement.judge, judgement.repeat)
        self._known[key] = judgement
        self._waiting.pop(key, None)
        self.made.append(judgement)
        if self.path is not None:
            append_line(self.path, _line(sample, judgement))

    def done(self) -> None:
        """Remove from the file the judgements that the log now contains. Those of another judge's interrupted rescoring stay."""
        if self.path is None:
            return
        left = [_line(sample, made) for (sample, _, _), made in self._waiting.items() if made.verdict != "failed"]
        if left:
            scratch = self.path.with_name(f"{self.path.name}.new")
            scratch.write_text("".join(line + "\n" for line in left), "utf-8")
            scratch.replace(self.path)
        else:
            self.path.unlink(missing_ok=True)


def _line(sample: str, judgement: Judgement) -> str:
    return json.dumps({"sample": sample, "judgement": judgement.model_dump(mode="json")}, ensure_ascii=False)
