"""A backend is one file, in the package or in an installed plug-in."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import scope_ptz.perception.backends as backends
from scope_ptz.errors import UnknownNameError
from scope_ptz.perception.backends.spec import BackendSpec

ONE_FILE = """
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points

class EmptyPerception(Perception):
    def __init__(self, name):
        self.name = name
    async def caption(self, frame):
        return Caption(text="Dark.", source=self.name)
    async def query(self, frame, question):
        return Answer(text="I cannot tell.", known=False, source=self.name)
    async def detect(self, frame, description):
        return Detections(boxes=(), source=self.name)
    async def point(self, frame, description):
        return Points(points=(), source=self.name)

def make(spec):
    return EmptyPerception(spec.name)
"""


def test_a_file_in_the_package_is_a_backend(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "blindfold.py").write_text(ONE_FILE)
    monkeypatch.setattr(backends, "__path__", [*backends.__path__, str(tmp_path)])
    assert "blindfold" in backends.backend_names()
    assert backends.make_backend(BackendSpec(name="dark", backend="blindfold")).name == "dark"


def test_an_installed_package_can_add_a_backend(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "someones_eyes.py").write_text(ONE_FILE)
    info = tmp_path / "someones_eyes-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: someones-eyes\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[scope_ptz.perception]\nhooded = someones_eyes:make\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert "hooded" in backends.backend_names()
    assert backends.make_backend(BackendSpec(name="dark", backend="hooded")).name == "dark"


def test_built_in_backends_are_listed() -> None:
    assert {"moondream", "openai_vision", "transformers_local", "zero_shot", "ocr", "router"} <= set(backends.backend_names())
    with pytest.raises(UnknownNameError, match="Did you mean 'moondream'"):
        backends.make_backend(BackendSpec(name="x", backend="moondreem"))


def test_large_packages_are_imported_only_when_they_are_used() -> None:
    """A backend that asks a server loads neither its HTTP client nor a model library when it is made."""
    script = """
import sys
from scope_ptz.perception.backends import make_backend, backend_names
from scope_ptz.perception.backends.spec import BackendSpec
backend_names()
for backend in ("moondream", "openai_vision"):
    make_backend(BackendSpec(name="x", backend=backend, endpoint={"url": "http://127.0.0.1:9/v1", "model": "m"}))
print(sorted({"openai", "httpx2", "torch", "transformers", "rapidocr", "onnxruntime", "json_repair"} & set(sys.modules)))
"""
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.strip() == "[]"
