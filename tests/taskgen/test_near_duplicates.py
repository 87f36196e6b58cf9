"""Near-duplicates: the same question in other words, nearly the same words, and tasks that differ."""

from __future__ import annotations

from scope_ptz.taskgen.facts.near_duplicates import KnownTasks, shingles, similarity
from tests.bench.sample_runs import samples

COUNT, OTHER = (task for task, _ in samples()[:2])


def test_the_same_question_about_the_same_view_is_found_in_any_wording() -> None:
    near = KnownTasks([COUNT]).most_similar(
        COUNT.model_copy(update={"id": "scope1-test-001", "instruction": "Over to highway: cones?"})
    )
    assert near is not None and (near.task, near.similarity) == (COUNT.id, 1.0)


def test_similar_words_are_found_only_within_a_world() -> None:
    instruction = "Go to the highway preset and count all of the red cones that you see."
    known = KnownTasks([OTHER.model_copy(update={"instruction": instruction})])
    similar = COUNT.model_copy(update={"instruction": "Please " + instruction.lower()})
    near = known.most_similar(similar)
    assert near is not None and 0.75 <= near.similarity < 1
    assert known.most_similar(similar.model_copy(update={"variation": 3})) is None
    assert known.most_similar(COUNT.model_copy(update={"instruction": "Pan left by 40 degrees and read the sign there."})) is None


def test_similarity_is_jaccard() -> None:
    assert similarity(shingles("one car"), shingles("One  CAR!")) == 1.0
    assert similarity(shingles("pan left 20"), shingles("tilt up")) == 0.0
    assert similarity(frozenset("abcd"), frozenset("cdef")) == 2 / 6
