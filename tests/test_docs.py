"""The documentation names files, pages and public names that exist. `make docs` also builds the site strictly."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import scope_ptz
from scope_ptz import contracts

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = sorted(page for page in DOCS.rglob("*.md") if "_build" not in page.parts)
TEXTS = [*PAGES, ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"]
ARCHITECTURE = (DOCS / "architecture.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("path", sorted(set(re.findall(r"`([\w-]+/[\w/-]*(?:\.\w+)?)`", ARCHITECTURE))))
def test_architecture_names_files_that_exist(path: str) -> None:
    places = [ROOT, ROOT / "src", ROOT / "src" / "scope_ptz"]
    assert any((place / path).exists() for place in places), f"docs/architecture.md names {path}, which does not exist"


@pytest.mark.parametrize("page", TEXTS, ids=lambda page: str(page.relative_to(ROOT)))
def test_linked_files_exist(page: Path) -> None:
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    targets = re.findall(r"\]\(([^)\s#]+)(?:#[^)]*)?\)", text)
    missing = [target for target in targets if "://" not in target and not (page.parent / target).exists()]
    assert not missing


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(DOCS)))
def test_included_files_exist(page: Path) -> None:
    included = re.findall(r"^```\{literalinclude\} (\S+)", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert all((page.parent / path).is_file() for path in included)


def test_every_page_is_in_the_index() -> None:
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    indexed = set(re.findall(r"^[a-z][a-z/-]*$", index, flags=re.MULTILINE))
    assert {str(page.relative_to(DOCS).with_suffix("")) for page in PAGES} - {"index"} == indexed


def test_the_api_page_documents_every_public_name() -> None:
    documented = re.findall(r"^\.\. (?:auto\w+|py:data):: (\S+)", (DOCS / "api.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    expected = {f"scope_ptz.{name}" for name in scope_ptz.__all__ if name != "__version__"}
    expected |= {f"scope_ptz.contracts.{name}" for name in contracts.__all__ if name not in scope_ptz.__all__}
    assert set(documented) == expected
    assert len(documented) == len(expected)
