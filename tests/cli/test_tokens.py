"""``scope token``: tokens are shown once and stored as hashes."""

from __future__ import annotations

from pathlib import Path

from tests.cli.conftest import Scope


def test_tokens_are_added_listed_and_removed(scope: Scope, tmp_path: Path) -> None:
    file = str(tmp_path / "tokens.json")
    added = scope("token", "add", "anna", "--role", "operator", "--tokens", file)
    secret = added.out.strip()
    assert secret.startswith("scope_")
    assert "cannot be shown again" in added.err
    assert secret not in Path(file).read_text()
    listed = scope("token", "list", "--tokens", file, "--json")
    assert [(each["name"], each["role"]) for each in listed.json] == [("anna", "operator")]
    assert secret not in listed.out
    assert scope("token", "add", "anna", "--tokens", file).code == 2
    assert "--role must be viewer or operator" in scope("token", "add", "ben", "--role", "king", "--tokens", file).err
    assert scope("token", "remove", "anna", "--tokens", file).code == 0
    assert "There is no token" in scope("token", "remove", "anna", "--tokens", file).err
    assert "No tokens" in scope("token", "list", "--tokens", file).out


def test_a_server_of_unknown_cameras_does_not_start(scope: Scope) -> None:
    result = scope("serve", "--camera", "axis://operator@10.0.0.7", "--port", "0")
    assert (result.code, "There is no camera or scene" in result.err) == (2, True)
