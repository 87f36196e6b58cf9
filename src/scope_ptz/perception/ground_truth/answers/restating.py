"""Convert parsed descriptions and tests back to words, so that an answer shows how its question was understood."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import lexicon, nouns_in, singular_phrase
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.numerals import ORDINALS
from scope_ptz.perception.ground_truth.relations import BACKGROUND_CONCEPTS, is_outside
from scope_ptz.perception.ground_truth.thing_facts import is_sexed
from scope_ptz.perception.ground_truth.thing_search import has_outside, split_after_noun
from scope_ptz.perception.ground_truth.view import View

_PRONOUNS = {
    **dict.fromkeys(("anyone", "anybody", "someone", "somebody", "everyone", "everybody", "people"), "person"),
    "traffic": "vehicle",
    **dict.fromkeys(("they", "he", "she"), "person"),
    **dict.fromkeys(("anything", "something", "everything"), "thing"),
}
SUPERLATIVES = {
    "left": "leftmost", "right": "rightmost", "top": "topmost", "bottom": "lowest", "nearest": "nearest",
    "furthest": "furthest", "biggest": "biggest", "smallest": "smallest", "tallest": "tallest", "widest": "widest",
    "looks biggest": "biggest-looking", "looks smallest": "smallest-looking",
}  # fmt: skip
COMPARATIVES = {
    "left": "further to the left", "right": "further to the right", "top": "higher in the picture",
    "bottom": "lower in the picture", "nearest": "closer", "furthest": "further away", "biggest": "bigger",
    "smallest": "smaller", "tallest": "taller", "widest": "wider", "looks biggest": "bigger in the picture",
    "looks smallest": "smaller in the picture",
}  # fmt: skip
FIRST_OF_SEVERAL = {
    "left": "the furthest to the left", "right": "the furthest to the right", "top": "the highest in the picture",
    "bottom": "the lowest in the picture", "nearest": "the closest", "furthest": "the furthest away", "biggest": "the biggest",
    "smallest": "the smallest", "tallest": "the tallest", "widest": "the widest",
    "looks biggest": "the biggest in the picture", "looks smallest": "the smallest in the picture",
}  # fmt: skip
EQUAL_WORDS = {
    "left": "equally far to the left", "right": "equally far to the right", "top": "equally high in the picture",
    "bottom": "equally low in the picture", "nearest": "equally far away", "furthest": "equally far away",
    "biggest": "the same size", "smallest": "the same size", "tallest": "the same height", "widest": "equally wide",
    "looks biggest": "the same size in the picture", "looks smallest": "the same size in the picture",
}  # fmt: skip
_RELATIONS = {
    "left": "to the left of", "right": "to the right of", "above": "above", "below": "below", "front": "in front of",
    "behind": "behind", "near": "next to", "on": "on", "facing": "facing",
}  # fmt: skip
_FROM_SIDE = {"left": "from the left", "right": "from the right", "top": "from the top", "bottom": "from the bottom"}


def is_plural(description: tree.Description) -> bool:
    """Return whether a description is plural."""
    return len(description.phrases) > 1 or any(english.is_plural(x) for p in description.phrases for x in _head_words(p.words)[-1:])


def _head_words(words: Sequence[str]) -> Sequence[str]:
    """Return the words before "for" or "of": "price card" for "price card for roses"."""
    end = next((i for i, word in enumerate(words) if word in {"for", "of"} and i), len(words))
    return words[:end]


def noun_phrase(view: View, description: tree.Description, plural: bool = False) -> str:
    """Return a description in words, without articles: "red cars behind the barrier"."""
    several = len(description.phrases) > 1
    return english.listing(
        [_phrase_words(view, p, plural or (several and is_plural(tree.Description((p,))))) for p in description.phrases]
    )


def definite_phrase(view: View, description: tree.Description, plural: bool = False) -> str:
    """Return a description with definite articles: "the red car", "the van and the lorry"."""
    if len(description.phrases) == 1:
        words = noun_phrase(view, description, plural)
        return words if words.split()[-1].isdigit() and not description.phrases[0].tests else f"the {words}"  # "dock 6"
    return english.listing([f"the {_phrase_words(view, p, is_plural(tree.Description((p,))))}" for p in description.phrases])


def phrase_as_asked(view: View, description: tree.Description) -> str:
    """Return a description with the question's own articles: "the van", "a white helmet", "grey pipes"."""
    return english.listing([_with_article(view, phrase) for phrase in description.phrases])


def _with_article(view: View, phrase: tree.Phrase) -> str:
    words = _phrase_words(view, phrase, is_plural(tree.Description((phrase,))))
    if phrase.article == "a":
        return english.article(words)
    return f"the {words}" if phrase.article == "the" or _lacks_article(phrase) else words


def _lacks_article(phrase: tree.Phrase) -> bool:
    """Return whether a phrase needs an article that its question left out: "doors on tram"."""
    concept = lexicon().concept(phrase.words[-1]) if phrase.words else None
    is_bare = phrase.words[-1:] != ("traffic",) and not phrase.tests and not is_plural(tree.Description((phrase,)))
    return concept is not None and is_bare


def definite_as_asked(view: View, description: tree.Description) -> str:
    """Return a description with definite articles, in the singular or plural as in the question."""
    return definite_phrase(view, description, is_plural(description))


def _phrase_words(view: View, phrase: tree.Phrase, plural: bool) -> str:
    head, after = split_after_noun(view, phrase.words)
    if len(head) > 1 and head[0] in _PRONOUNS and head[0] != "traffic":  # "anyone buying bread"
        head, after = head[:1], (*head[1:], *after)
    owner = next((t for t in phrase.tests if isinstance(t, tree.Relation) and t.kind == "on" and not t.preposition), None)
    if owner is not None and not (phrase.order or phrase.ordinal):
        part = _phrase_words(view, replace(phrase, tests=tuple(t for t in phrase.tests if t is not owner)), plural)
        return f"{noun_phrase(view, owner.other, is_plural(owner.other))}'s {part}"
    core = [*head[:-1], _PRONOUNS.get(head[-1], english.singular(head[-1]))] if head else ["thing"]
    if phrase.order is not None or phrase.ordinal is not None:
        return " ".join([*_ranked_words(view, phrase, " ".join(core)), *after, *_test_words(view, phrase)])
    shown = english.plural(" ".join(core)) if plural and not (after and english.is_plural(after[-1])) else " ".join(core)
    return " ".join([shown, *after, *_test_words(view, phrase)])


def _test_words(view: View, phrase: tree.Phrase) -> list[str]:
    return [words for words in (words_after_noun(view, t) for t in phrase.tests) if words]


def _ranked_words(view: View, phrase: tree.Phrase, core: str) -> list[str]:
    ordinal = "" if phrase.ordinal is None else "last" if phrase.ordinal == -1 else _ordinal_word(phrase.ordinal)
    if phrase.order is None:
        return [ordinal, core]
    if phrase.order.reference is not None:
        return [
            x for x in (ordinal, core, SUPERLATIVES[phrase.order.key], "to", definite_as_asked(view, phrase.order.reference)) if x
        ]
    if ordinal and phrase.order.key in _FROM_SIDE:
        return [ordinal, core, _FROM_SIDE[phrase.order.key]]
    return [x for x in (ordinal, SUPERLATIVES[phrase.order.key], core) if x]


def _ordinal_word(number: int) -> str:
    """Return an ordinal: up to the tenth as a word, otherwise in digits."""
    return next((word for word, value in ORDINALS.items() if value == number), f"{number}{english.ordinal_suffix(number)}")


def words_after_noun(view: View, test: tree.Test) -> str:
    """Return a test as words after a noun: "behind the barrier", "with a helmet", "that are parked"."""
    match test:
        case tree.Has(what=what, sold=True):
            return f"selling {' and '.join(' '.join(p.words) for p in what.phrases)}"
        case tree.Has(what=what, worn=worn):
            has_pronoun = any(p.words[-1] in _PRONOUNS for p in what.phrases)
            return f"{'wearing' if worn else 'carrying' if has_pronoun else 'with'} {_item_phrases(what)}"
        case tree.Says(words=words):
            return f'saying "{" ".join(words).upper()}"' if words else "with text"
        case tree.Not(test=tree.Has(what=what)):
            return f"without {_item_phrases(what)}"
        case tree.Not(test=tree.Any(tests=tests)):
            return f"other than {english.listing([words_after_noun(view, t) for t in tests])}"
        case tree.Not(test=inner):
            return f"not {words_after_noun(view, inner)}"
        case tree.Any(tests=tests):
            return english.listing([words_after_noun(view, t) for t in tests], "or")
        case tree.Order(key=key, reference=reference):
            return f"{SUPERLATIVES[key]} to {definite_as_asked(view, reference)}" if reference else SUPERLATIVES[key]
        case _:
            return _plain_test_words(view, test)


def _plain_test_words(view: View, test: tree.Test) -> str:
    match test:
        case tree.Relation(kind=kind, other=other, preposition=preposition):
            shown = preposition if (kind == "on" and preposition) or is_outside(preposition) else _RELATIONS[kind]
            return f"{shown} {phrase_as_asked(view, other)}"
        case tree.Within(metres=metres, other=other, beyond=beyond):
            reference = f" of {phrase_as_asked(view, other)}" if other else ""
            return f"{'more than' if beyond else 'within'} {metres:g} m{reference}"
        case tree.Between(first=first, second=second):
            return f"between {phrase_as_asked(view, first)}" + ("" if first == second else f" and {phrase_as_asked(view, second)}")
        case tree.Region(sides=sides, half=half):
            return region_words(sides, half)
        case tree.Measured(key=key, other=other):
            return f"{COMPARATIVES[key]} than {phrase_as_asked(view, other)}"
        case tree.Faces(side=side):
            return f"facing {side}"
        case tree.Is(words=words):
            return " ".join(words)
        case _:
            return ""


def _item_phrases(what: tree.Description, count: int | None = None) -> str:
    """Return parts or clothes with their articles: "helmets" for several people, "a helmet" for one; by default, as asked."""
    return english.listing([_item_phrase(" ".join(p.words), p.words[-1] in _PRONOUNS, count) for p in what.phrases])


def _item_phrase(words: str, is_pronoun: bool, count: int | None) -> str:
    last = words.split()[-1]
    if count == 1 and lexicon().concept(last) in _ONE_EACH:
        return english.article(singular_phrase(words))  # one of the people has "a bag", although the question is about bags
    if is_pronoun or english.is_plural(last) or last in english.COLOURS:
        return words  # "wearing red"
    return english.plural(words) if count is not None and count != 1 else english.article(words)


_ONE_EACH = frozenset({"bag", "backpack", "umbrella", "hard hat", "hi-vis vest", "jacket", "hat"})
"""Items of which a person has one."""


def predicate_words(view: View, tests: Sequence[tree.Test], count: int, negated: bool = False) -> str:
    """Return tests as a predicate: "are parked", "does not have a ladder", "is next to the van"."""
    words: list[str] = []
    for i, test in enumerate(tests):
        before = tests[i - 1] if i else None
        if not negated and isinstance(before, tree.Is) and isinstance(test, tree.Relation | tree.Region):
            words[-1] += f" {words_after_noun(view, test)}"  # "is parked in bay 12"
        elif isinstance(before, tree.Is) and before.words[-1] == "for" and isinstance(test, tree.Is):
            words[-1] += f" {english.article(' '.join(test.words))}"  # "is waiting for a taxi"
        else:
            words.append(_predicate_of_test(view, test, count, negated))
    return english.listing(words, "or" if negated else "and")


def _predicate_of_test(view: View, test: tree.Test, count: int, negated: bool) -> str:
    match test:
        case tree.Not(test=inner):
            return _predicate_of_test(view, inner, count, not negated)
        case tree.Has(what=what, sold=True):
            return f"{_verb_form('sell', 'sells', count, negated)} {' and '.join(' '.join(p.words) for p in what.phrases)}"
        case tree.Has(what=what, worn=False):
            return f"{_verb_form('have', 'has', count, negated)} {_item_phrases(what, count)}"
        case tree.Has(what=what):
            return f"{_form_of_be(count, negated)} wearing {_item_phrases(what, count)}"
        case tree.Says(words=()):
            return f"{_verb_form('bear', 'bears', count, negated)} text that I can read"
        case tree.Says(words=words):
            return f'{_verb_form("say", "says", count, negated)} "{" ".join(words).upper()}"'
        case tree.Is(words=words) if is_sexed(words):
            noun = english.singular(words[-1])
            return f"{_form_of_be(count, negated)} {english.article(noun) if count == 1 else english.plural(noun)}"
        case tree.Is(words=words) if words and english.is_plural(words[-1]) is False and words[-1] in _PREDICATE_NOUNS:
            return f"{_form_of_be(count, negated)} {english.article(' '.join(words))}"
        case _:
            return f"{_form_of_be(count, negated)} {words_after_noun(view, test)}"


_PREDICATE_NOUNS = frozenset(["car", "van", "lorry", "truck", "bus", "worker", "person", "cone", "vehicle", "digger", "excavator"])


def _form_of_be(count: int, negated: bool) -> str:
    return ("is" if count == 1 else "are") + (" not" if negated else "")


def _verb_form(plural: str, singular: str, count: int, negated: bool) -> str:
    if negated:
        return f"{'does' if count == 1 else 'do'} not {plural}"
    return singular if count == 1 else plural


def region_words(sides: Sequence[str], half: bool) -> str:
    """Return a part of the frame in words: "on the left", "in the top half"."""
    if tuple(sides) in {("near",), ("far",)}:
        return "in the foreground" if sides[0] == "near" else "in the distance"
    if half:
        return f"in the {' '.join(sides)} {'half' if len(sides) == 1 else 'quarter'}"
    if len(sides) > 1:
        return f"at the {' '.join(sides)}"
    return {"middle": "in the middle", "top": "at the top", "bottom": "at the bottom"}.get(sides[0], f"on the {sides[0]}")


def none_in_view(view: View, description: tree.Description) -> str:
    """Return the statement that nothing matches: "there is no red car in view"."""
    description = tree.Description(tuple(replace(p, order=None, ordinal=None) for p in description.phrases))
    plural = is_plural(description)
    only_one = len(description.phrases) > 1 and not any(is_plural(tree.Description((p,))) for p in description.phrases)
    words = english.listing([noun_phrase(view, tree.Description((p,)), plural and not only_one) for p in description.phrases], "or")
    return f"there {'are' if plural and not only_one else 'is'} no {words} in view"


def unmodelled_background(view: View, description: tree.Description) -> str:
    """Return the background ("lane", "sky") that a description names but the scene does not model; empty for other descriptions.

    The background may be visible although the scene does not list it.
    """
    return next((words for phrase in description.phrases if (words := _background_in(view, phrase))), "")


def unmodelled_place(view: View, description: tree.Description) -> str:
    """Return the unmodelled background in a description ("people in the street", "nearest to the road"), or an empty string."""
    relations = [t for p in description.phrases for t in p.tests if isinstance(t, tree.Relation)]
    places = [t.other for t in relations if t.preposition != "of"]  # a pile of sand is a thing
    places += [p.order.reference for p in description.phrases if p.order is not None and p.order.reference is not None]
    background = next((words for place in (description, *places) if (words := unmodelled_background(view, place))), "")
    return background or place_without_outside(view, description)


def place_without_outside(view: View, description: tree.Description) -> str:
    """Return the place in "cars outside the site" that has no outside which a picture shows; empty for buildings and others."""
    relations = [t for p in description.phrases for t in p.tests if isinstance(t, tree.Relation) and is_outside(t.preposition)]
    return next((noun_phrase(view, t.other) for t in relations if not has_outside(view, t.other)), "")


def _background_in(view: View, phrase: tree.Phrase) -> str:
    spans = nouns_in(phrase.words, view.nouns)
    words = " ".join(phrase.words[slice(*spans[0])]) if spans else ""
    concept = lexicon().concept(words) if words else None
    return words if concept and lexicon().kinds(concept) & BACKGROUND_CONCEPTS and concept not in view.concepts else ""
