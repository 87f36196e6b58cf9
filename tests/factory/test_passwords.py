"""Passwords come from the environment, the keyring or a prompt, and from nowhere else."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import keyring
import keyring.backend
import pytest

from scope_ptz.camera.spec import CameraSpec
from scope_ptz.errors import ConfigError, InputError
from scope_ptz.factory.cameras import parse_camera
from scope_ptz.factory.cameras.passwords import find_credentials, store_password

SPEC = CameraSpec("axis", "operator@10.0.0.7")


class MemoryKeyring(keyring.backend.KeyringBackend):
    """An in-memory keyring."""

    priority = 1

    def __init__(self) -> None:
        self.passwords: dict[tuple[str, str], str] = {}

    def get_password(self, service: str, username: str) -> str | None:
        return self.passwords.get((service, username))

    def set_password(self, service: str, username: str, password: str) -> None:
        self.passwords[service, username] = password

    def delete_password(self, service: str, username: str) -> None:
        del self.passwords[service, username]


@pytest.fixture(autouse=True)
def ring(monkeypatch: pytest.MonkeyPatch) -> Iterator[MemoryKeyring]:
    monkeypatch.delenv("SCOPE_CAMERA_PASSWORD", raising=False)
    memory_keyring = MemoryKeyring()
    before = keyring.get_keyring()
    keyring.set_keyring(memory_keyring)
    yield memory_keyring
    keyring.set_keyring(before)


def test_the_keyring_keeps_one_password_per_account(ring: MemoryKeyring) -> None:
    store_password(SPEC, "kept secret")
    assert find_credentials(SPEC).password == "kept secret"
    with pytest.raises(ConfigError, match="no password for admin@"):
        find_credentials(CameraSpec("axis", "admin@10.0.0.7"))


def test_the_environment_comes_first(ring: MemoryKeyring, monkeypatch: pytest.MonkeyPatch) -> None:
    store_password(SPEC, "kept secret")
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", "from the environment")
    found = find_credentials(SPEC)
    assert (found.user, found.password) == ("operator", "from the environment")
    assert "from the environment" not in repr(found)


def test_a_camera_file_selects_the_source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ring: MemoryKeyring) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scope.yaml").write_text(
        "cameras:\n  a: {camera: 'axis://operator@10.0.0.7', password: env:YARD}\n"
        "  b: {camera: 'axis://operator@10.0.0.7', password: keyring}\n"
    )
    monkeypatch.setenv("SCOPE_CAMERA_PASSWORD", "of all cameras")
    monkeypatch.setenv("YARD", "of the yard")
    ring.passwords["scope-ptz", "operator@10.0.0.7"] = "of the keyring"
    assert find_credentials(parse_camera("a")).password == "of the yard"
    assert find_credentials(parse_camera("b")).password == "of the keyring"
    monkeypatch.delenv("YARD")
    with pytest.raises(ConfigError, match="scope camera password a"):
        find_credentials(parse_camera("a"))


def test_an_account_and_a_password_are_needed() -> None:
    with pytest.raises(InputError, match="axis://USER@10"):
        find_credentials(CameraSpec("axis", "10.0.0.7"))
    with pytest.raises(InputError, match="empty"):
        store_password(SPEC, "")


def test_a_broken_keyring_is_treated_as_empty(ring: MemoryKeyring, monkeypatch: pytest.MonkeyPatch) -> None:
    def raise_locked(*_: str) -> str:
        raise RuntimeError("locked")

    monkeypatch.setattr(ring, "get_password", raise_locked)
    monkeypatch.setattr(ring, "set_password", raise_locked)
    with pytest.raises(ConfigError, match="There is no password"):
        find_credentials(SPEC)
    with pytest.raises(ConfigError, match="did not store"):
        store_password(SPEC, "x")
