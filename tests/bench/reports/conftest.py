"""An invented sweep and its report, shared by the tests of a session."""

from __future__ import annotations

import pytest

from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import sweep


@pytest.fixture(scope="session")
def evaluations() -> list[Evaluation]:
    return sweep(6)


@pytest.fixture(scope="session")
def report(evaluations: list[Evaluation]) -> EvaluationReport:
    return build_report(evaluations, load_registry())
