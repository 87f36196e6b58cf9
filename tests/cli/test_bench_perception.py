"""Ground truth reports an absence only for descriptions that it fully understands."""

from __future__ import annotations

import pytest

from scope_ptz.factory.validation_perception import is_plain_noun
from scope_ptz.perception.ground_truth.view import read_view
from tests.perception import yard

VIEW = read_view(yard.truth(), yard.SCENE, 5.0)


@pytest.mark.parametrize(
    "description", ["cars", "the red cars", "traffic cones", "buses", "a green van", "red cars and white vans"]
)
def test_colours_and_a_known_noun_are_plain(description: str) -> None:
    assert is_plain_noun(VIEW, description)


@pytest.mark.parametrize(
    "description",
    ["flibbertigibbets", "things on wheels", "objects like cars", "total number of cars", "workers with blue helmets"],
)
def test_unknown_nouns_additional_words_and_conditions_are_not_plain(description: str) -> None:
    assert not is_plain_noun(VIEW, description)
