"""The systemd unit in the documentation: systemd accepts it, and its command, options and settings exist."""

from __future__ import annotations

import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from scope_ptz.settings import ScopeSettings

UNIT = Path(__file__).parents[1] / "docs" / "scope-console.service"
TEXT = UNIT.read_text(encoding="utf-8")


@pytest.fixture
def service() -> dict[str, str]:
    """Return the options of the service. The values of a repeated option are joined by newlines."""
    found: dict[str, str] = {}
    section = TEXT.partition("[Service]\n")[2].partition("\n[")[0]
    for line in section.splitlines():
        if line and not line.startswith("#"):
            name, _, value = line.partition("=")
            found[name] = f"{found[name]}\n{value}" if name in found else value
    return found


def test_the_unit_starts_the_console_with_existing_options(service: dict[str, str]) -> None:
    program, command, *options = shlex.split(service["ExecStart"])
    assert Path(program).name == "scope"
    assert command == "console"
    result = subprocess.run([sys.executable, "-m", "scope_ptz.cli", command, "--help"], capture_output=True, text=True, check=True)
    for option in options:
        assert not option.startswith("--") or option in result.stdout


def test_settings_are_known_and_contain_no_secret(service: dict[str, str]) -> None:
    variables = dict(line.split("=", 1) for line in service["Environment"].splitlines())
    known = {f"SCOPE_{name.upper()}" for name in ScopeSettings.model_fields}
    assert set(variables) - known == {"HOME"}
    secret = {f"SCOPE_{name.upper()}" for name, field in ScopeSettings.model_fields.items() if "SecretStr" in str(field.annotation)}
    assert not secret & set(variables)
    assert not [name for name in secret if f"{name}=" in TEXT]
    assert service["EnvironmentFile"].startswith("-/etc/")


def test_the_unit_stops_the_console_like_ctrl_c(service: dict[str, str]) -> None:
    assert service["KillSignal"] == "SIGINT"
    assert service["SuccessExitStatus"] == "130"


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd is not installed")
def test_systemd_accepts_the_unit(tmp_path: Path, service: dict[str, str]) -> None:
    # The program and the user of a real installation do not exist here.
    program = shutil.which("true")
    text = TEXT.replace(shlex.split(service["ExecStart"])[0], str(program)).replace("=scope\n", "=daemon\n", 2)
    unit = tmp_path / UNIT.name
    unit.write_text(text)
    result = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", str(unit)],  # noqa: S607
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    problems = [line for line in result.stderr.splitlines() if UNIT.name in line]
    assert (result.returncode, problems) == (0, []), result.stderr
    unit.write_text(text.replace("KillSignal=SIGINT", "KillSignal=SIGNOTHING"))
    wrong = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", str(unit)],  # noqa: S607
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert "SIGNOTHING" in wrong.stderr, "this version of systemd does not validate values"
