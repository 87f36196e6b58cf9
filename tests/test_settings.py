"""Settings from environment variables."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.errors import ConfigError
from scope_ptz.settings import ScopeSettings, load_settings


@pytest.fixture(autouse=True)
def clear_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ScopeSettings.model_fields:
        monkeypatch.delenv(f"SCOPE_{name.upper()}", raising=False)


def test_defaults_hold_without_variables() -> None:
    assert load_settings() == ScopeSettings()
    assert load_settings().runs_dir == Path("runs")


def test_variables_are_read_in_any_case_and_unknown_ones_are_ignored(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_RUNS_DIR", "elsewhere")
    monkeypatch.setenv("scope_planner_url", "http://127.0.0.1:1/v1")
    monkeypatch.setenv("SCOPE_NO_SUCH_THING", "1")
    monkeypatch.setenv("SCOPE_PLANNER_KEY", "secret")
    settings = load_settings()
    assert (settings.runs_dir, settings.planner_url) == (Path("elsewhere"), "http://127.0.0.1:1/v1")
    assert settings.planner_key is not None and settings.planner_key.get_secret_value() == "secret"
    assert "secret" not in repr(settings)


def test_a_wrong_value_names_its_variable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scope_ptz.settings.ScopeSettings", Numbered)
    monkeypatch.setenv("SCOPE_ATTEMPTS", "many")
    with pytest.raises(ConfigError, match=r"The environment variable SCOPE_ATTEMPTS has an invalid value: .*integer"):
        load_settings()


class Numbered(ScopeSettings):
    """Settings with an integer field, because any text is valid for the real fields."""

    attempts: int = 1
