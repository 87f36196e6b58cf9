"""``scope camera serve``: wrong options, and the program from its start to Ctrl-C."""

from __future__ import annotations

import hashlib
import json
import os
import re
import signal
import ssl
import subprocess
import sys
from pathlib import Path

import httpx2
import pytest

from scope_ptz.cli.camera.serve import parse_faults
from scope_ptz.errors import ConfigError, InputError
from scope_ptz.factory.cameras.virtual import VirtualCameraOptions, make_accounts, make_devices
from scope_ptz.settings import ScopeSettings
from scope_ptz.virtual_camera.accounts import Role
from tests.cli.conftest import SCENE, Scope
from tests.support.programs import start_program


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--scene", "nowhere"], "There is no scene 'nowhere'"),
        (["--scene", SCENE, "--viewpoint", "cellar"], "There is no viewpoint 'cellar'"),
        (["--scene", SCENE, "--scene", SCENE, "--viewpoint", "mast"], "one viewpoint per scene"),
        (["--scene", SCENE, "--time-scale", "0"], "time scale"),
        (["--scene", SCENE, "--fault", "stall"], "NAME=VALUE"),
        (["--scene", SCENE, "--fault", "rain=1"], "Unknown fault 'rain'"),
        (["--scene", SCENE, "--fault", "drop=2"], "drop: "),
        (["--scene", SCENE, "--user", "root", "--no-accounts"], "not both"),
        (["--scene", SCENE, "--user", "root:king"], "There is no role 'king'"),
        (["--scene", SCENE, "--user", "root", "--user", "root"], "must have a unique name"),
        (["--scene", SCENE, "--no-accounts", "--host", "0.0.0.0", "--port", "0"], "open to the network"),  # noqa: S104
        (["--scene", SCENE, "--host", "192.0.2.1", "--port", "0"], "cannot be used"),
    ],
)
def test_wrong_options_give_one_line(scope: Scope, options: list[str], message: str) -> None:
    result = scope("camera", "serve", *options)
    assert result.code == 2
    assert message in result.err
    assert result.out == ""
    assert len(result.err.splitlines()) == 1


def test_help_lists_the_command(scope: Scope) -> None:
    assert "serve" in scope("camera", "--help").out
    assert "camera" in scope("--help").out


def test_faults_are_parsed() -> None:
    texts = ["drop=0.5", "unauthorized=true", "stuck=pan,tilt", "picture=black", "clock_skew_s=-3600"]
    assert parse_faults(texts) == {
        "drop": 0.5,
        "unauthorized": True,
        "stuck": ["pan", "tilt"],
        "picture": "black",
        "clock_skew_s": -3600,
    }
    with pytest.raises(InputError):
        parse_faults(["drop"])


def test_each_account_gets_its_own_password_unless_one_is_configured() -> None:
    root, guard = make_accounts(["root", "guard:operator"], ScopeSettings(virtual_camera_password=None))
    assert (root.role, guard.role) == (Role.ADMINISTRATOR, Role.OPERATOR)
    assert root.password != guard.password
    assert len(root.password) >= 16
    assert root.password not in repr(root)
    chosen = ScopeSettings.model_validate({"virtual_camera_password": "chosen"})
    assert [account.password for account in make_accounts(["a", "b:viewer"], chosen)] == ["chosen", "chosen"]
    with pytest.raises(ConfigError, match="SCOPE_VIRTUAL_CAMERA_PASSWORD is empty"):
        make_accounts(["a"], ScopeSettings.model_validate({"virtual_camera_password": ""}))


def test_frozen_time_does_not_stop_the_motors(scenes: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(scenes))
    (frozen,) = make_devices(VirtualCameraOptions(scenes=(SCENE,), freeze_time=True, time_scale=50.0), [])
    (running,) = make_devices(VirtualCameraOptions(scenes=(SCENE,)), [])
    assert frozen.clock.now_s() == frozen.clock.now_s() == frozen.scene.file.start_s
    assert frozen.time_scale == 50.0
    assert running.clock.now_s() < running.clock.now_s()


@pytest.mark.full
def test_the_program_serves_until_ctrl_c(scenes: Path) -> None:
    command = [sys.executable, "-m", "scope_ptz.cli", "camera", "serve", "--scene", SCENE, "--viewpoint", "roof", "--port", "0"]
    environment = {**os.environ, "SCOPE_SCENES_DIR": str(scenes)}
    with start_program([*command, "--truth", "--json"], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        description = json.loads(process.stdout.readline())
        (camera,) = description["cameras"]
        assert (camera["scene"], camera["viewpoint"]) == (SCENE, "roof")
        auth = httpx2.DigestAuth("root", description["passwords"]["root"])
        with httpx2.Client(base_url=camera["url"], auth=auth, trust_env=False, timeout=60) as session:
            assert session.get("/axis-cgi/com/ptz.cgi", params={"query": "position"}).text.startswith("pan=")
            picture = session.get("/axis-cgi/jpg/image.cgi")
            assert picture.headers["x-scope-viewpoint"] == "roof"
        process.send_signal(signal.SIGINT)
        rest, errors = process.communicate(timeout=30)
    assert (process.returncode, rest, errors) == (130, "", "scope: cancelled.\n")


@pytest.mark.full
def test_the_fingerprint_of_the_certificate_is_printed(scenes: Path) -> None:
    command = [sys.executable, "-m", "scope_ptz.cli", "camera", "serve", "--scene", SCENE, "--port", "0", "--https"]
    environment = {**os.environ, "SCOPE_SCENES_DIR": str(scenes)}
    with start_program(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
        assert process.stdout is not None
        lines = [process.stdout.readline()]
        while "Ctrl-C" not in lines[-1]:
            lines.append(process.stdout.readline())
            assert process.poll() is None
        text = "".join(lines)
        port = int(re.search(r"^  ONVIF: +https://127\.0\.0\.1:(\d+)/onvif/", text, flags=re.MULTILINE)[1])  # type: ignore[index]
        fingerprint = hashlib.sha256(ssl.PEM_cert_to_DER_cert(ssl.get_server_certificate(("127.0.0.1", port)))).hexdigest()
        (printed_fingerprint,) = re.findall(r"certificate \(SHA-256\): ([0-9A-F:]{95})$", text, flags=re.MULTILINE)
        assert printed_fingerprint.replace(":", "").lower() == fingerprint
        assert "curl --insecure --digest" in text
        process.send_signal(signal.SIGTERM)
        rest = process.communicate(timeout=30)[0]
    assert (process.returncode, rest) == (130, "scope: cancelled.\n")


@pytest.mark.full
def test_a_configured_password_is_never_printed(scenes: Path) -> None:
    command = [sys.executable, "-m", "scope_ptz.cli", "camera", "serve", "--scene", SCENE, "--port", "0"]
    environment = {**os.environ, "SCOPE_SCENES_DIR": str(scenes), "SCOPE_VIRTUAL_CAMERA_PASSWORD": "very-secret"}
    with start_program(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
        assert process.stdout is not None
        lines = [process.stdout.readline()]
        while "Ctrl-C" not in lines[-1]:
            lines.append(process.stdout.readline())
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        lines += process.communicate(timeout=30)[0].splitlines()
    text = "\n".join(lines)
    assert "very-secret" not in text
    assert "Account root (administrator), password from SCOPE_VIRTUAL_CAMERA_PASSWORD" in text
    assert "curl --digest --user root" in text
