"""The documentation pages of scenes are identical to their generated cards."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.simulator.card import markdown
from scope_ptz.simulator.pack import list_scenes, load_scene

DOCS = Path(__file__).parent.parent / "docs"


@pytest.mark.parametrize("name", list_scenes())
def test_a_scene_has_its_card_in_the_docs(name: str) -> None:
    picture = f"../images/{name}.jpg"
    page = DOCS / "scenes" / f"{name}.md"
    assert page.read_text() == markdown(load_scene(name), picture), f"scope scene show {name} --markdown --contact-sheet {picture}"
    assert (page.parent / picture).is_file()
    assert f"({page.relative_to(DOCS)})" in (DOCS / "scenes.md").read_text()
