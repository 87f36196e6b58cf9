"""The installable file of the add-on."""

from __future__ import annotations

import ast
import json
import tomllib
import zipfile
from pathlib import Path

from typer.testing import CliRunner

from scope_ptz.blender.addon_zip import addon_folder, addon_zip
from scope_ptz.cli.app import app


def test_the_command_builds_one_file_for_all_versions(tmp_path: Path) -> None:
    path = tmp_path / "new" / "scope.zip"
    done = CliRunner().invoke(app, ["blender-addon", "build", "--out", str(path), "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout) == {"file": str(path)}
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        names = archive.namelist()
        manifest = tomllib.loads(archive.read("scope_addon/blender_manifest.toml").decode())
        code = ast.parse(archive.read("scope_addon/__init__.py"))
    assert all(name.startswith("scope_addon/") and ".." not in name for name in names)
    assert {"scope_addon/protocol/link.py", "scope_addon/scene/executor.py", "scope_addon/ui/panels.py"} < set(names)
    (info,) = [
        ast.literal_eval(node.value)
        for node in code.body
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "bl_info"
    ]
    assert ".".join(map(str, info["version"])) == manifest["version"]
    assert (info["blender"], manifest["blender_version_min"], manifest["id"]) == ((3, 4, 0), "4.2.0", "scope_addon")


def test_the_file_is_the_same_every_time() -> None:
    assert addon_zip() == addon_zip()
    compiled = addon_folder() / "__pycache__"
    assert compiled.name not in addon_zip().decode("latin-1")


def test_a_folder_that_cannot_be_written_is_explained(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    done = CliRunner().invoke(app, ["blender-addon", "build", "--out", str(blocked / "scope.zip")])
    assert done.exit_code == 2
    assert "cannot be written" in done.stderr
