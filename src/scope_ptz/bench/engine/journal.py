"""Judgements as they are made, so that a rescoring that is killed loses none: a file beside the log, gone when the log has them."""

from __future__ import annotations

import json
from contextvars import ContextVar
from pathlib import Path

from pydantic import ValidationError

from scope_ptz.bench.judging.lines import append_line, whole_lines
from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.trials import Judgement
from scope_ptz.errors import TraceError


class Journal:
    """Judgements by run, judge and number; ``made``: how many were added. Without a path none are known before."""

    def __init__(self, path: Path | None = None) -> None:
        self.path = path
        self.made = 0
        self._known: dict[tuple[str, str, int], Judgement] = {}
        for number, line in whole_lines(path) if path is not None else ():
            try:
                row = json.loads(line)
                made = Judgement.model_validate(row["judgement"])
                self._known[(row["sample"], made.judge, made.repeat)] = made
            except (ValueError, KeyError, TypeError, ValidationError) as error:
                raise TraceError(f"{path}, line {number} is no judgement: remove the line, or the file. ({error})") from error

    @classmethod
    def beside(cls, log: Path) -> Journal:
        """The journal of a log."""
        return cls(log.with_suffix(".judgements.jsonl"))

    def find(self, sample: str, judge: str, repeat: int) -> Judgement | None:
        """A judgement by today's prompt that reached a verdict; one that failed is to be made again."""
        made = self._known.get((sample, judge, repeat))
        return made if made is not None and made.prompt == prompt_version() and made.verdict != "failed" else None

    def know(self, sample: str, judgement: Judgement) -> None:
        """A judgement that the log has already."""
        self._known.setdefault((sample, judgement.judge, judgement.repeat), judgement)

    def add(self, sample: str, judgement: Judgement) -> None:
        """Keep a judgement."""
        self._known[(sample, judgement.judge, judgement.repeat)] = judgement
        self.made += 1
        if self.path is not None:
            row = {"sample": sample, "judgement": judgement.model_dump(mode="json")}
            append_line(self.path, json.dumps(row, ensure_ascii=False))

    def done(self) -> None:
        """The log has all of it."""
        if self.path is not None:
            self.path.unlink(missing_ok=True)


JOURNAL: ContextVar[Journal | None] = ContextVar("scope_journal", default=None)
