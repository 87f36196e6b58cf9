"""Named cameras in scope.yaml: the file, its validation, and the rules of a named camera."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scope_ptz.camera.guard.guarded_camera import GuardedCamera
from scope_ptz.errors import ConfigError, InputError
from scope_ptz.factory.cameras import camera_names, open_camera, parse_camera
from scope_ptz.factory.cameras.site_file import CameraFile, load_camera_file, schema
from scope_ptz.geometry import Pose

FILE = """
version: 1
cameras:
  yard-gate:
    camera: sim:highway-works?width=160&height=90
    mounting: {position: upright}
    rules:
      keep_out: [{name: windows, pan_deg: [20, 50], tilt_deg: [-30, 20]}]
      soft_limits: {max_pan_deg: 90}
    audit_log: logs/audit.jsonl
  roof: {camera: "sim:highway-works?width=160&height=90"}
"""


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scope.yaml").write_text(FILE)
    return tmp_path


@pytest.mark.anyio
async def test_a_named_camera_keeps_the_rules_of_its_site(site: Path) -> None:
    async with await open_camera("yard-gate", actor="anna") as handle:
        assert str(handle.spec) == "yard-gate"
        assert isinstance(handle.camera, GuardedCamera)
        handle.record_instruction("look at the windows")
        arrival = await handle.camera.move(Pose(30.0, 0.0, 1.0))
        assert arrival.limited_by == "the keep-out region 'windows'"
        assert handle.camera.info.limits.max_pan_deg == 90.0
    entries = [json.loads(line) for line in (site / "logs" / "audit.jsonl").read_text().splitlines()]
    assert [entry["event"] for entry in entries] == ["instruction", "move", "arrived"]
    assert entries[0]["text"] == "look at the windows"
    assert {(entry["actor"], entry["camera"]) for entry in entries} == {("anna", "yard-gate")}


@pytest.mark.anyio
async def test_a_named_camera_without_rules_is_not_wrapped(site: Path) -> None:
    async with await open_camera("roof") as handle:
        assert not isinstance(handle.camera, GuardedCamera)


def test_names_are_listed_and_scenes_stay_reachable(site: Path) -> None:
    assert camera_names()[:2] == ("yard-gate", "roof")
    assert parse_camera("highway-works").scheme == "sim"
    assert parse_camera("yard-gate").options == {"width": "160", "height": "90"}


def test_a_file_can_be_named_in_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    elsewhere = tmp_path / "elsewhere.yaml"
    elsewhere.write_text(FILE)
    monkeypatch.setenv("SCOPE_CONFIG", str(elsewhere))
    assert parse_camera("roof").name == "roof"
    elsewhere.unlink()
    with pytest.raises(ConfigError, match="cannot be read"):
        parse_camera("roof")


@pytest.mark.parametrize(("text", "message"), [
    ("cameras: [", "not valid YAML on line"),
    ("- 1", "invalid at the top level"),
    ("version: 7", "invalid at version"),
    ("cameras: {Yard: {camera: 'sim:x'}}", "Yard"),
    ("cameras: {a: {}}", "cameras.a.camera"),
    ("cameras: {a: {camera: 'sim:x', colour: red}}", "cameras.a.colour"),
    ("cameras: {a: {camera: 'sim:x', rules: {keep_out: [{name: n, pan_deg: [1, 1]}]}}}", "with two different angles"),
    ("cameras: {a: {camera: 'sim:x', fingerprint: '12:34'}}", "64 hexadecimal digits"),
])  # fmt: skip
def test_an_invalid_file_is_rejected_with_the_position_of_the_error(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "scope.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=message):
        load_camera_file(path)


def test_a_password_in_the_file_is_refused_and_not_repeated(tmp_path: Path) -> None:
    path = tmp_path / "scope.yaml"
    path.write_text("cameras: {a: {camera: 'axis://op@10.0.0.7', password: hunter2}}")
    with pytest.raises(ConfigError, match="keyring, prompt, or env:NAME") as excinfo:
        load_camera_file(path)
    assert "hunter2" not in str(excinfo.value)


def test_a_named_spec_needs_a_scheme_and_no_password(site: Path) -> None:
    (site / "scope.yaml").write_text("cameras: {a: {camera: b}, b: {camera: a}, c: {camera: 'axis://op:hunter2@10.0.0.7'}}")
    with pytest.raises(InputError, match="must have a spec with a scheme"):
        parse_camera("a")
    with pytest.raises(InputError, match="Remove user:password@") as excinfo:
        parse_camera("c")
    assert "hunter2" not in str(excinfo.value)


@pytest.mark.parametrize("content", [b"\xff\xfe", b"a: &a [*a]", b"x" * 2_000_000, b"[" * 5000])
def test_malformed_files_give_a_config_error(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "scope.yaml"
    path.write_bytes(content)
    with pytest.raises(ConfigError):
        load_camera_file(path)


def test_an_empty_file_names_no_cameras(tmp_path: Path) -> None:
    path = tmp_path / "scope.yaml"
    path.write_text("")
    assert load_camera_file(path) == load_camera_file(None) == CameraFile()


def test_the_schema_describes_every_field() -> None:
    schema_text = json.dumps(schema())
    for field in ("keep_out", "soft_limits", "masks", "dead_zone_deg", "min_interval_s", "mounting", "audit_log", "fingerprint"):
        assert field in schema_text
