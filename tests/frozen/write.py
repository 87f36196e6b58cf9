"""Write the results of the current code to a folder with the layout of the stored data, to compare the two with diff.

python -m tests.frozen.write /tmp/today && diff -r /tmp/today tests/frozen/v0_1_0
"""

from __future__ import annotations

import gzip
import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tests.frozen import adapter, cases


def put(path: Path, content: Any) -> None:
    """Write JSON with sorted keys, one value per line, so that diffs are small."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=1, ensure_ascii=False, sort_keys=True) + "\n", "utf-8")


def write(out: Path, scratch: Path, *, slow: bool) -> None:
    """Write all results. ``slow`` includes those that take minutes."""
    for name, function in cases.SIMPLE.items():
        put(out / name, function())
    for name in cases.CONVERSATIONS:
        put(out / "conversations" / f"{name}.json", cases.conversation(name, scratch / name))
    put(out / "looks.json", {name: cases.vision_requests(name, scratch / f"look-{name}") for name in cases.VISION_INSTRUCTIONS})
    for name in cases.LOG_NAMES:
        content, rescored = cases.log_content(name), cases.rescored_log(name, scratch / "logs")
        assert content["evaluation"] == rescored["evaluation"]
        put(out / "logs" / f"{name}.json", {**content, "rescored": rescored["scores"]})
    put(out / "judging.json", cases.judge_results(scratch / "judging"))
    for name, text in cases.tables(scratch / "tables").items():
        (out / "tables").mkdir(exist_ok=True)
        (out / "tables" / name).write_text(text, "utf-8", newline="")
    lines = cases.submission(out / "submission.jsonl")
    assert lines
    put(out / "submission.json", cases.submission_checks(scratch))
    if slow:
        put(out / "validate.json", dict(zip(("code", "report"), adapter.validate_tasks(), strict=True)))
        put(out / "gold.json", dict(zip(("code", "report"), adapter.check_gold(), strict=True)))
        rows = cases.plan_inputs()
        plans = cases.plans(rows, scratch / "instructions.jsonl")
        plan_lines = [
            json.dumps({"task": row["task"], "world": row["world"], "plan": plan}, ensure_ascii=False)
            for row, plan in zip(rows, plans, strict=True)
        ]
        with (out / "plans.jsonl.gz").open("wb") as file, gzip.GzipFile("", "wb", 9, file, mtime=0) as packed:
            packed.write(("\n".join(plan_lines) + "\n").encode())


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        write(Path(sys.argv[1]), Path(folder), slow="--slow" in sys.argv)
