"""Addresses and keys: what is accepted, what is refused, and that a key is never shown."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import SecretStr

from scope_ptz.endpoints.endpoint import Endpoint, Timeouts, key_from_file
from scope_ptz.errors import ConfigError
from scope_ptz.settings import load_settings

KEY = "sk-very-secret-0123456789"


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        ("http://127.0.0.1:8000/v1", "http://127.0.0.1:8000/v1"),
        (" https://api.example.org/v1/ ", "https://api.example.org/v1"),
        ("http://[::1]:8000", "http://[::1]:8000"),
    ],
)
def test_addresses(given: str, kept: str) -> None:
    assert Endpoint(url=given).url == kept


@pytest.mark.parametrize(
    "url",
    [
        "", "127.0.0.1:8000", "localhost:8000/v1", "ftp://host/v1", "http://", "http://host:99999/v1", "http://host:port/v1",
        f"http://user:{KEY}@host/v1", f"http://{KEY}@host/v1", f"http://host/v1?key={KEY}", f"http://host/v1#{KEY}",
        f"user:{KEY}@host/v1", f"ftp://user:{KEY}@host", "http://ho st/v1", "http://host/v1\x00",
    ],
)  # fmt: skip
def test_invalid_addresses_are_errors(url: str) -> None:
    with pytest.raises(ConfigError) as caught:
        Endpoint(url=url)
    assert KEY not in str(caught.value)


def test_a_key_is_never_shown() -> None:
    at = Endpoint(url="http://host/v1", key=SecretStr(KEY))
    assert at.secret == KEY
    assert KEY not in f"{at} {at!r} {at.model_dump()} {at.model_dump_json()}"


@pytest.mark.parametrize("key", [f"{KEY}\nX-Other: 1", f"{KEY} more", f"{KEY}é", KEY * 1000])
def test_invalid_keys_are_errors(key: str) -> None:
    with pytest.raises(ConfigError) as caught:
        Endpoint(url="http://host/v1", key=SecretStr(key))
    assert KEY not in str(caught.value)


def test_a_blank_key_is_none() -> None:
    assert Endpoint(url="http://host/v1", key=SecretStr(" \n")).key is None


def test_keys_from_files(tmp_path: Path) -> None:
    file = tmp_path / "key"
    file.write_text(f"{KEY}\n")
    key = key_from_file(file)
    assert key is not None
    assert key.get_secret_value() == KEY
    file.write_bytes(b"\xff\xfe\x00")
    for path in (file, tmp_path / "none", tmp_path):
        with pytest.raises(ConfigError, match="cannot be read"):
            key_from_file(path)


def test_keys_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for role in ("PLANNER", "PERCEPTION", "JUDGE"):
        monkeypatch.setenv(f"SCOPE_{role}_KEY", f"{KEY}-{role}")
    settings = load_settings()
    assert KEY not in f"{settings} {settings!r}"
    assert settings.perception_key is not None
    assert settings.perception_key.get_secret_value() == f"{KEY}-PERCEPTION"


@pytest.mark.parametrize(("total_s", "first_byte_s"), [(0.5, 0.5), (30, 30), (100, 60), (600, 300)])
def test_timeouts_within_a_time(total_s: float, first_byte_s: float) -> None:
    patience = Timeouts.within(total_s)
    assert (patience.first_byte_s, patience.total_s) == (first_byte_s, total_s)
    assert patience.connect_s <= total_s


@pytest.mark.parametrize("seconds", [0, -1, float("nan"), float("inf")])
def test_timeouts_are_positive_and_finite(seconds: float) -> None:
    with pytest.raises(ValueError, match="total_s"):
        Timeouts(total_s=seconds)
