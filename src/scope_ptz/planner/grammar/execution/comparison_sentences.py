"""Phrase counts, and their sums, differences and orders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from scope_ptz import english
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.execution import answer_sentences as phrases
from scope_ptz.planner.grammar.execution.visible_counts import are_complete, number_text


def counts_text(parts: Sequence[ast.Tally], counts: Sequence[int]) -> str:
    """Return several counts as a sentence: "I can see 3 planters at approach and 2 at tram-stop"."""
    same = len({part.thing.text for part in parts}) == 1
    places = [part.place.name for part in parts if part.place is not None]
    if same and len(places) == len(set(places)) == len(parts) and list(counts).count(0) > _MAX_LISTED_ZEROS:
        return counts_at_presets(parts[0].thing.text, dict(zip(places, counts, strict=True)))
    listed = [
        number_text(count) + _at(part)
        if same and i
        else phrases.counted(part.thing.text, count) + (_at(part) or (" here" if places else ""))
        for i, (part, count) in enumerate(zip(parts, counts, strict=True))
    ]
    where = "" if any(part.place for part in parts) else phrases.where(parts[0].view or "current")
    return f"I can see {english.listing(listed)}{where}"


def _at(part: ast.Tally) -> str:
    return f" at {part.place.name}" if part.place is not None else ""


def counts_and_difference_text(parts: Sequence[ast.Tally], counts: Sequence[int]) -> str:
    """Return two counts at presets with their difference: "I can see 3 cars at gate and 1 at yard, so there are 2 more at gate"."""
    difference = counts[0] - counts[1]
    if not are_complete(counts):
        return f"{counts_text(parts, counts)}. {_unknown_difference(parts[0].thing.text)}"
    if not difference or parts[0].place is None:
        return f"{counts_text(parts, counts)}. That is the same number at both, so the difference is 0"
    verb, comparison = ("is" if abs(difference) == 1 else "are"), ("more" if difference > 0 else "fewer")
    return f"{counts_text(parts, counts)}, so there {verb} {abs(difference)} {comparison} at {parts[0].place.name}"


def _unknown_difference(text: str) -> str:
    return f"I cannot tell the exact difference, because there may be more {phrases.noun(text, 2)} that are too small or hidden"


def is_one_kind_at_two_presets(first: ast.Tally, second: ast.Tally) -> bool:
    """Return whether two counts are of the same objects, each at a preset."""
    return first.thing.text == second.thing.text and first.place is not None and second.place is not None


def difference_text(first: ast.Tally, second: ast.Tally, counts: tuple[int, int]) -> str:
    """Return the difference of two counts: "There are 5 more bicycles than planters"."""
    if not are_complete(counts):
        return _unknown_difference(first.thing.text)
    difference = counts[0] - counts[1]
    if not difference:
        return "That is the same number of both, so the difference is 0"
    number = abs(difference)
    noun = phrases.noun(first.thing.text, number)
    verb, comparison = ("is" if number == 1 else "are"), ("more" if difference > 0 else "fewer")
    return f"There {verb} {number} {comparison} {noun} than {_compared_with(first.thing.text, second.thing.text)}"


def _compared_with(first: str, second: str) -> str:
    """Return what a count is compared with: "vans", or only the place if both counts are of the same kind ("in the left half")."""
    (kind, place), (other, rest) = phrases.head_and_rest(first), phrases.head_and_rest(second)
    same = kind.removeprefix("the ") == other.removeprefix("the ")
    if same and place[1:].startswith(_PLACES) and rest[1:].startswith(_PLACES):
        return rest[1:]
    return phrases.noun(second, 2)


_PLACES = ("in ", "on ", "at ", "near ", "next to ", "behind ", "under ", "above ", "below ", "inside ", "outside ", "to the ")


def ranking_text(parts: Sequence[ast.Tally], counts: Sequence[int], first: ast.Comparison) -> str:
    """Return several counts in their order: "From most to fewest: 5 bicycles, 3 benches and 2 planters"."""
    ranked = sorted(zip(parts, counts, strict=True), key=lambda pair: pair[1], reverse=first == "more")
    if not are_complete(counts):
        return f"{counts_text(parts, counts)}. I cannot tell their order for certain, because some may be too small or hidden"
    if len(set(counts)) == 1 and len(counts) > 1:
        return f"{counts_text(parts, counts)}. {_all_equal_text(len(counts))}"
    order = "from most to fewest" if first == "more" else "from fewest to most"
    listed = [f"{phrases.counted(part.thing.text, count)}{_at(part)}" for part, count in ranked]
    tied = [
        english.listing([_name(part) for part, other in ranked if other == count])
        for count in dict.fromkeys(count for _, count in ranked)
        if list(counts).count(count) > 1 and count
    ]
    ties = "".join(f". {phrases.sentence(f'{names} are equal')[:-1]}" for names in tied)
    return f"{order}: {english.listing(listed)}{ties}"


def _all_equal_text(number: int) -> str:
    return "That is the same number of both" if number == 2 else f"All {phrases.count_word(number)} numbers are the same"


def winner_text(parts: Sequence[ast.Tally], counts: Sequence[int], first: ast.Comparison) -> str:
    """Return which of several kinds has the most or the fewest objects: "There are more skips than any of the others"."""
    best = max(counts) if first == "more" else min(counts)
    winners = [phrases.noun(part.thing.text, 2) for part, count in zip(parts, counts, strict=True) if count == best]
    if len(winners) > 1:
        return f"It is a tie between {english.listing(winners)}" if are_complete(counts) else _CANNOT_TELL_WHICH
    hedge = "" if are_complete(counts) else "as far as I can see, "
    return f"{hedge}there are {first} {winners[0]} than any of the others"


def here_or_there_text(parts: Sequence[ast.Tally], counts: Sequence[int], way: ast.Comparison) -> str:
    """Return where there are more, or fewer, of the same objects: "There are more vans here than at docks"."""
    here, there = counts
    place = parts[1].place.name if parts[1].place is not None else "there"
    things = phrases.noun(parts[0].thing.text, 2)
    if here == there:
        return f"There are as many {things} here as at {place}" if are_complete(counts) else _CANNOT_TELL_WHICH
    hedge = "" if are_complete(counts) else "as far as I can see, "
    is_here = (here > there) == (way == "more")
    where = f"here than at {place}" if is_here else f"at {place} than here"
    return f"{hedge}there are {way} {things} {where}"


_CANNOT_TELL_WHICH = "I cannot tell which, because there may be more that are too small or hidden"


def _name(part: ast.Tally) -> str:
    return part.place.name if part.place is not None else f"the {phrases.noun(part.thing.text, 2)}"


def counts_at_presets(text: str, counts: Mapping[str, int]) -> str:
    """Return the counts at presets: "I can see 3 cars at gate and no cars at yard"."""
    shown = {name: count for name, count in counts.items() if count}
    zeros = len(counts) - len(shown)
    if zeros <= _MAX_LISTED_ZEROS or not are_complete(count for count in counts.values() if not count):
        return f"I can see {english.listing([f'{phrases.counted(text, count)} at {name}' for name, count in counts.items()])}"
    if not shown:
        return f"I can see {phrases.counted(text, 0)} at any of the {zeros} presets"
    listed = [f"{phrases.counted(text, n) if not i else number_text(n)} at {name}" for i, (name, n) in enumerate(shown.items())]
    return f"I can see {english.listing(listed)}, and none at the other {zeros} presets"


_MAX_LISTED_ZEROS = 2
"""Maximum number of presets without the objects to list by name."""


def any_of_text(step: ast.WhichPreset, counts: Mapping[str, int]) -> str:
    """Return which presets show any of the objects."""
    text = step.thing.text
    seen = [f"{phrases.counted(text, count)} at {name}" for name, count in counts.items() if count]
    missing = [name for name, count in counts.items() if not count]
    answer = f"I can see {english.listing(seen)}" if seen else f"I can see {phrases.counted(text, 0)} at {_either(missing)}"
    if seen and missing:
        answer += f", but none at {_either(missing)}"
    return f"{'Yes' if seen else 'No'}: {answer}" if step.yes_no else answer


def _either(names: Sequence[str]) -> str:
    return english.listing(list(names), "or")


def presets_of_rank(counts: Mapping[str, int], comparison: ast.Comparison, rank: int) -> list[str]:
    """Return the presets at a place in the order of their counts. Presets with equal counts share a place."""
    ordered = sorted(counts.values(), reverse=comparison == "more")
    return [name for name, count in counts.items() if count == ordered[rank - 1]] if rank <= len(ordered) else []


def best_preset_text(step: ast.WhichPreset, counts: Mapping[str, int], ranked: Sequence[str]) -> str:
    """Return which preset has the requested place in the order of the counts."""
    if not ranked:
        return f"There are only {len(counts)} presets to compare"
    if len(ranked) > 1:
        is_tie = are_complete(counts[name] for name in ranked) and not set(ranked) & set(step.lower_bounds)
        each = f", with {counts[ranked[0]]} each" if step.numbers else ""
        return f"It is a tie between {english.listing(list(ranked))}{each}" if is_tie else _CANNOT_TELL_WHICH
    nth = "" if step.rank == 1 else f"{_ordinal(step.rank)} "
    if len(counts) == 2 and step.rank == 1:
        amount: str = step.comparison
    else:
        amount = f"the {nth}{'most' if step.comparison == 'more' else 'fewest'}"
    if step.numbers:
        least = "at least " if ranked[0] in step.lower_bounds else ""
        had = f"preset {ranked[0]} had {amount} {phrases.noun(step.thing.text, 2)}, with {least}{counts[ranked[0]]}"
        return f"as far as I could see, {had}" if step.lower_bounds else had
    hedge = "" if are_complete(count for name, count in counts.items() if name != ranked[0]) else "as far as I can see, "
    return f"{hedge}preset {ranked[0]} shows {amount} {phrases.noun(step.thing.text, 2)}"


def _ordinal(rank: int) -> str:
    return {2: "second", 3: "third", 4: "fourth", 5: "fifth"}.get(rank, f"{rank}{english.ordinal_suffix(rank)}")
