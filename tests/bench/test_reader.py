"""The reader against answers written by hand, right and wrong, of every kind."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest
import yaml
from pydantic import TypeAdapter

from scope_ptz.bench.expected import ActionOnly, AnyExpected, Expected
from scope_ptz.bench.reader import agrees, read
from scope_ptz.bench.reading import Declined

DATA = Path(__file__).parent / "data"
ADAPTER: TypeAdapter[AnyExpected] = TypeAdapter(Expected)
EXPECTATIONS = {
    name: ADAPTER.validate_python(content)
    for name, content in yaml.safe_load((DATA / "expectations.yaml").read_text("utf-8")).items()
}
ANSWERS = [json.loads(line) for line in (DATA / "answers.jsonl").read_text("utf-8").splitlines()]


def verdict(expected: AnyExpected, answer: str) -> str:
    if isinstance(expected, ActionOnly):
        return "right"
    reading = read(expected, answer)
    if isinstance(reading, Declined):
        return "declined"
    return {True: "right", False: "wrong", None: "unscored"}[agrees(expected, reading)]


@pytest.mark.parametrize("case", ANSWERS, ids=[f"{c['expected']}-{i}" for i, c in enumerate(ANSWERS)])
def test_an_answer_is_read_as_a_person_reads_it(case: dict[str, str]) -> None:
    expected = EXPECTATIONS[case["expected"]]
    assert verdict(expected, case["answer"]) == case["verdict"], (case["answer"], read(expected, case["answer"]))


def test_the_answers_are_many_and_of_every_kind() -> None:
    assert len(ANSWERS) >= 300
    kinds = Counter(EXPECTATIONS[c["expected"]].kind for c in ANSWERS)
    assert set(kinds) == {e.kind for e in EXPECTATIONS.values()}
    assert len(kinds) == 10
    for kind in set(kinds) - {"action_only"}:
        verdicts = {c["verdict"] for c in ANSWERS if EXPECTATIONS[c["expected"]].kind == kind}
        assert {"right", "wrong"} <= verdicts, kind
