"""Phrase counts, and their sums, differences and orders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from scope_ptz import english
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.execution import answer_sentences as phrases


def counts_text(parts: Sequence[ast.Tally], counts: Sequence[int]) -> str:
    """Return several counts as a sentence: "I can see 3 planters at approach and 2 at tram-stop"."""
    same = len({part.thing.text for part in parts}) == 1
    listed = [
        (str(count) if count else "none") + _at(part)
        if same and i
        else phrases.counted(part.thing.text, count) + (_at(part) if part.place else "")
        for i, (part, count) in enumerate(zip(parts, counts, strict=True))
    ]
    where = "" if any(part.place for part in parts) else f" {phrases.where(parts[0].view or 'current')}"
    return f"I can see {english.listing(listed)}{where}"


def _at(part: ast.Tally) -> str:
    return f" at {part.place.name}" if part.place is not None else ""


def difference_text(first: ast.Tally, second: ast.Tally, difference: int) -> str:
    """Return the difference of two counts: "There are 5 more bicycles than planters"."""
    if first.thing.text == second.thing.text and first.place is not None and second.place is not None:
        if not difference:
            return "That is the same number at both, so the difference is 0"
        comparison = "more" if difference > 0 else "fewer"
        verb = "is" if abs(difference) == 1 else "are"
        return f"There {verb} {abs(difference)} {comparison} at {first.place.name} than at {second.place.name}"
    if not difference:
        return "That is the same number of both, so the difference is 0"
    number = abs(difference)
    noun = phrases.noun(first.thing.text, number)
    verb, comparison = ("is" if number == 1 else "are"), ("more" if difference > 0 else "fewer")
    return f"There {verb} {number} {comparison} {noun} than {phrases.noun(second.thing.text, 2)}"


def ranking_text(parts: Sequence[ast.Tally], counts: Sequence[int], first: ast.Comparison) -> str:
    """Return several counts in their order: "From most to fewest: 5 bicycles, 3 benches and 2 planters"."""
    ranked = sorted(zip(parts, counts, strict=True), key=lambda pair: pair[1], reverse=first == "more")
    order = "from most to fewest" if first == "more" else "from fewest to most"
    listed = [f"{phrases.counted(part.thing.text, count)}{_at(part)}" for part, count in ranked]
    tied = [part for part, count in ranked if list(counts).count(count) > 1]
    names = english.listing([_name(part) for part in tied])
    return f"{order}: {english.listing(listed)}" + (f". {phrases.sentence(f'{names} are equal')[:-1]}" if tied else "")


def _name(part: ast.Tally) -> str:
    return part.place.name if part.place is not None else f"the {phrases.noun(part.thing.text, 2)}"


def counts_at_presets(text: str, counts: Mapping[str, int]) -> str:
    """Return the counts at presets: "I can see 3 cars at gate and no cars at yard"."""
    return f"I can see {english.listing([f'{phrases.counted(text, count)} at {name}' for name, count in counts.items()])}"


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
    """Return the presets at a place in the order of their counts. Presets with equal counts share their places."""
    ordered = sorted(counts.values(), reverse=comparison == "more")
    return [name for name, count in counts.items() if count == ordered[rank - 1]] if rank <= len(ordered) else []


def best_preset_text(step: ast.WhichPreset, counts: Mapping[str, int], ranked: Sequence[str]) -> str:
    """Return which preset has the requested place in the order of the counts."""
    if not ranked:
        return f"There are only {len(counts)} presets to compare"
    if len(ranked) > 1:
        return f"It is a tie between {english.listing(list(ranked))}"
    nth = "" if step.rank == 1 else f"{_ordinal(step.rank)} "
    if len(counts) == 2 and step.rank == 1:
        amount: str = step.comparison
    else:
        amount = f"the {nth}{'most' if step.comparison == 'more' else 'fewest'}"
    return f"Preset {ranked[0]} shows {amount} {phrases.noun(step.thing.text, 2)}"


def _ordinal(rank: int) -> str:
    return {2: "second", 3: "third", 4: "fourth", 5: "fifth"}.get(rank, f"{rank}{english.ordinal_suffix(rank)}")
