"""Public names of the package: the list, signatures and documentation, and the cost of importing them."""

from __future__ import annotations

import doctest
import inspect
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import scope_ptz
import scope_ptz.contracts

PINNED = Path(__file__).with_name("public_names.json")
"""The pinned names and signatures. Regenerate after an intended change with ``python -m tests.api.test_public_names``."""

CLASSES = [name for name in scope_ptz.__all__ if inspect.isclass(getattr(scope_ptz, name))]
FUNCTIONS = [name for name in scope_ptz.__all__ if inspect.isfunction(getattr(scope_ptz, name))]
OURS = [name for name in CLASSES if getattr(scope_ptz, name).__module__.startswith("scope_ptz.api.")]
ERRORS = [name for name in CLASSES if issubclass(getattr(scope_ptz, name), Exception)]


def public_interface() -> dict[str, Any]:
    """Return the names and signatures of the public interface, including the public members of classes."""
    names: dict[str, Any] = {}
    for name in sorted(scope_ptz.__all__):
        value = getattr(scope_ptz, name)
        if name in OURS:
            names[name] = {member: _signature(vars(value)[member]) for member in sorted(vars(value)) if not member.startswith("_")}
        else:
            names[name] = str(inspect.signature(value)) if name in FUNCTIONS else type(value).__name__
    return {"scope_ptz": names, "scope_ptz.contracts": sorted(scope_ptz.contracts.__all__)}


def _signature(member: Any) -> str:
    if isinstance(member, staticmethod | classmethod):
        member = member.__func__
    return str(inspect.signature(member)) if inspect.isfunction(member) else "attribute"


def test_names_and_signatures_are_pinned() -> None:
    assert json.loads(PINNED.read_text("utf-8")) == public_interface()


def test_every_name_exists_and_is_listed() -> None:
    assert set(scope_ptz.__all__) <= set(dir(scope_ptz))
    assert all(name in (scope_ptz.__doc__ or "") for name in scope_ptz.__all__ if name != "__version__")
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        scope_ptz.nothing  # noqa: B018


def test_a_module_and_its_public_names_agree() -> None:
    for module, names in scope_ptz._MODULES.items():
        assert all(getattr(sys.modules[module], name) is getattr(scope_ptz, name) for name in names)
    assert {"__version__", *scope_ptz._MODULE_OF} == set(scope_ptz.__all__)


def test_importing_the_package_loads_nothing_heavy() -> None:
    program = "import sys, scope_ptz; print(*sorted({'numpy', 'cv2', 'pydantic', 'anyio', 'PIL', 'typer'} & sys.modules.keys()))"
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == ""


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_document_arguments_results_and_an_example(name: str) -> None:
    function = getattr(scope_ptz, name)
    text = inspect.getdoc(function) or ""
    parameters = list(inspect.signature(function).parameters)
    assert "Returns:" in text
    assert "Example:" in text
    assert "Raises:" in text or not parameters
    if name != "open_async":  # it has the arguments of open
        assert all(re.search(rf"^    {parameter}: ", text, re.MULTILINE) for parameter in parameters)


@pytest.mark.parametrize("name", OURS)
def test_members_of_classes_are_documented(name: str) -> None:
    kind = getattr(scope_ptz, name)
    assert "Example:" in (kind.__doc__ or "")
    for member, value in vars(kind).items():
        if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, property | classmethod)):
            assert inspect.getdoc(getattr(kind, member)), f"{name}.{member}"


@pytest.mark.parametrize("name", [*OURS, *ERRORS])
def test_classes_have_a_description(name: str) -> None:
    assert (inspect.getdoc(getattr(scope_ptz, name)) or "").split("\n")[0].strip().endswith(".")


@pytest.mark.usefixtures("scenes_cache")
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name == "open" else [pytest.mark.full]) for name in (*FUNCTIONS, *OURS)]
)
def test_examples_in_docstrings_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    value = getattr(scope_ptz, name)
    members = vars(value).items() if inspect.isclass(value) else ()
    documented = [(name, value), *((f"{name}.{member}", m) for member, m in members if inspect.isfunction(m))]
    parser, runner = doctest.DocTestParser(), doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    messages: list[str] = []
    for title, thing in documented:
        examples = parser.get_doctest(inspect.getdoc(thing) or "", {}, title, None, None)
        runner.run(examples, out=messages.append)
    assert not runner.summarize(verbose=False).failed, "".join(messages)


if __name__ == "__main__":
    PINNED.write_text(json.dumps(public_interface(), indent=1) + "\n", "utf-8")
