"""Extract the statements from an answer, and find the things that they name or deny.

Questions, guesses and clauses that decline to answer are excluded.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from scope_ptz.bench.answers.absences import REMARK_SEPARATOR, is_denied_jointly, is_listed_as_absent, replace_crosses
from scope_ptz.bench.answers.claims import Claim, claim_of
from scope_ptz.bench.answers.tokenizer import Word, clean, plain_words, same_word, words_of

NEGATORS = frozenset({"no", "not", "never", "without", "neither", "nor", "none", "nobody", "nothing", "zero", "0", "lacks", "lack"})
"""Words that deny the things named after them."""
_CONTRAST_PHRASES = (
    ("rather", "than"), ("instead", "of"), ("other", "than"), ("apart", "from"), ("as", "opposed", "to"), ("unlike",),
    ("except",), ("except", "for"), ("besides",), ("excluding",), ("anything", "but"),
)  # fmt: skip
"""Phrases that name something only for contrast."""
_INTERCHANGEABLE_ARTICLES = frozenset({"a", "an", "the"})
"""Articles that are interchangeable inside a name."""

_ARTICLES = frozenset({"a", "an", "the", "one", "two", "three", "some", "its", "his", "their"})
"""Words that may occur between a contrast phrase and a name. After "and", they begin a new statement."""
_SUBJECTS = frozenset({"it", "they", "there", "i", "we", "this", "that"})
"""Words that begin a new statement after "and". An earlier negation does not apply to it."""
_SCOPE_ENDS = frozenset({"but", "just", "only", "however", "although", "though", "yet", "while", "whereas", "instead"})
"""Words that end the scope of a negation before them."""

_HEDGES = re.compile(
    r"\b((yes|no) if|maybe|perhaps|possibly|might|may|conceivably|i guess|just a guess|at a guess|or so|could (be|have)"
    r"(?! (found|seen|detected|made|spotted|identified|located)))\b"
)
"""Words that mark a clause as a guess."""
_REFUSAL_PHRASES = re.compile(
    r"\bnot (?:\w+ )?(tell|say|determine|determined|make|know|known|read|readable|compare|compared|rank|count|counted|judge|judged|"
    r"identify|identified|answer|answered|confirm|confirmed|decide|sure|certain|able|possible|legible|clear|"
    r"see (anything|clearly|enough))\b"
    r"|\b(unable|impossible|hard|difficult) to\b|\bno (way to|idea)\b|\b(unclear|illegible|unreadable|unknown|indeterminable)\b"
    r"|\b(no one|nobody|who|god) knows\b"
    r"|\btoo (\w+ )?(dark|blurry|blurred|small|far|distant|dim|unclear|bright|faint)\b.* to (\w+ )?"
    r"(see|tell|say|read|count|make|determine|identify|judge|be)\b"
)
"""Phrases that decline to answer, such as "cannot tell" and "too dark to see"."""

_CORRECTION = re.compile(
    r"\b(?:correction|i mean|i meant|or rather(?! than)|(?:scratch|strike) that|make (?:that|it)(?= \w+\W*$)|i stand corrected|"
    r"on second thoughts?|my mistake|oops|at first (?:it|they|there|i)\b[^.;!?\n]*?,? but)\b|"
    r"(?:^|[.,;!—-]\s*)(?:no,? )?(?:wait|hold on)\b(?=\W)",
    re.IGNORECASE,
)
"""Phrases that withdraw everything before them."""

_ABSENCE_PREDICATE = r"(is |are |was |were )?((now|currently|completely|entirely) )?(absent|missing|nowhere)\b"
"""Phrases after a name which state that the thing is absent."""
_DOUBLE_NEGATION = re.compile(
    r"\b(not|never) (no|without|zero|0|none)$|\bnot (true|the case|correct|right)( that)?( there (is|are|was|were))? no$"
    r"|\b(no|not|without|zero) (\w+ )?(shortage|lack|lacks|absence|want)( of)?$"
)
"""Double negations, such as "not without" and "no lack of"."""

_BEFORE_VERB_CAN = frozenset({"i", "we", "you", "they", "it", "that", "who", "nobody", "one"})
"""Words before "can" which show that it is the verb rather than a drinks can."""
_AFTER_VERB_CAN = frozenset({
    "not", "see", "be", "find", "only", "also", "make", "tell", "count", "spot", "confirm", "say", "identify", "read", "clearly",
    "just", "still", "barely", "definitely", "hardly", "detect", "recognise", "notice", "determine",
})  # fmt: skip
"""Words after "can" which show that it is the verb rather than a drinks can."""


@dataclass(frozen=True, slots=True)
class NameMention:
    """A mention of something in an answer.

    Attributes:
        name: The key of the thing that the words name.
        start: Position of the first word.
        end: Position after the last word.
        denied: Whether the answer denies the thing or states that it is absent.
        contrast: Whether the thing is named only for contrast ("unlike the van").
    """

    name: str
    start: int
    end: int
    denied: bool
    contrast: bool


@dataclass(frozen=True, slots=True)
class AnswerText:
    """The statements in an answer.

    Attributes:
        words: The words of the statements. Questions, guesses and clauses that decline to answer are excluded.
        declined: Whether a clause declined to answer, as in "I cannot tell".
        hedged: Whether a clause was a guess.
    """

    words: tuple[Word, ...]
    declined: bool
    hedged: bool

    def mentions(self, names: Mapping[str, Sequence[str]]) -> list[NameMention]:
        """Return the mentions of the given names.

        If wordings overlap, the longest one counts. Mentions without a claim are excluded: "no cone is missing" and "I looked for
        cones" claim nothing about cones.

        Args:
            names: The wordings of each name.
        """
        phrases = [(tuple(plain_words(w)), name) for name, wordings in names.items() for w in wordings]
        phrases.sort(key=lambda p: -len(p[0]))
        mentions, used = list[NameMention](), set[int]()
        for start in range(len(self.words)):
            for phrase, name in phrases:
                end = start + len(phrase)
                if phrase and self._is_at(phrase, start) and not used & set(range(start, end)):
                    used |= set(range(start, end))
                    claim = claim_of(self.words, start, end)
                    if claim is Claim.NOTHING or self._is_denied_twice(start, end):
                        break
                    denied = self.is_denied(start, end) if claim is Claim.STATED else claim is Claim.NOT_FOUND
                    mentions.append(NameMention(name, start, end, denied, self._is_contrast(start)))
                    break
        return mentions

    def in_brackets(self, at: int) -> bool:
        """Return whether the word at a position is inside round brackets."""
        gaps = "".join(word.gap for word in self.words[: at + 1])
        return gaps.count("(") > gaps.count(")")

    def _is_at(self, phrase: tuple[str, ...], start: int) -> bool:
        words = self.words[start : start + len(phrase)]
        return (
            len(words) == len(phrase)
            and not (phrase == ("can",) and self._is_verb(start))
            and words[0].clause == words[-1].clause
            and all(same_word(w.text, p) or {w.text, p} <= _INTERCHANGEABLE_ARTICLES for w, p in zip(words, phrase, strict=True))
        )

    def _is_verb(self, at: int) -> bool:
        """Return whether "can" is the verb rather than the noun."""
        before, after = self.words[max(0, at - 1) : at], self.words[at + 1 : at + 2]
        return any(w.text in _BEFORE_VERB_CAN for w in before) or any(w.text in _AFTER_VERB_CAN for w in after)

    def _is_contrast(self, start: int) -> bool:
        before = [w.text for w in self.words[max(0, start - 4) : start] if w.clause == self.words[start].clause]
        while before and before[-1] in _ARTICLES:
            before.pop()
        return any(tuple(before[-len(words) :]) == words for words in _CONTRAST_PHRASES)

    def is_denied(self, start: int, end: int) -> bool:
        """Return whether the words from ``start`` to ``end`` are negated."""
        return self._is_denied_before(start) or self.is_denied_after(end) or is_denied_jointly(self.words, start, end)

    def _is_denied_before(self, start: int) -> bool:
        segment = self.words[start].segment
        at = start - 1
        while at >= 0 and self.words[at].segment == segment:
            word = self.words[at]
            if word.text in NEGATORS and not (word.text == "0" and at > 0 and word.gap == ""):
                after = self.words[at + 1].text
                return not (word.text == "no" and after == "other") and not (word.text == "none" and after != "of")
            ends_list = word.text == "and" and self.words[at + 1].text in _ARTICLES | _SUBJECTS
            if word.text in _SCOPE_ENDS or ends_list:
                return False
            at -= 1
        return at >= 0 and self._continues_list(segment) and self._opens_denied_list(at)

    def _is_denied_twice(self, start: int, end: int) -> bool:
        """Return whether the words are part of a double negation, as in "no cone is missing"."""
        segment, clause = self.words[start].segment, self.words[end - 1].clause
        before = [w.text for w in self.words[max(0, start - 9) : start] if w.segment == segment]
        negations = [at for at in range(len(before) + 1) if before[at - 1 : at] and _DOUBLE_NEGATION.search(" ".join(before[:at]))]
        after = " ".join(w.text for w in self.words[end : end + 6] if w.clause == clause)
        return bool(negations) or (self._is_denied_before(start) and re.match(_ABSENCE_PREDICATE, after) is not None)

    def _continues_list(self, segment: int) -> bool:
        """Return whether a segment continues a denied list, as in "no cars, vans or buses"."""
        clause = next(w.clause for w in self.words if w.segment == segment)
        rest = [w.text for w in self.words if w.clause == clause and w.segment >= segment]
        segment_words = [w.text for w in self.words if w.segment == segment]
        return ("or" in rest or "nor" in rest) and not (
            set(segment_words) & (_SCOPE_ENDS | {"is", "are", "there", "it", "i", "yes"})
        )

    def _opens_denied_list(self, at: int) -> bool:
        """Return whether the segment that ends at position ``at`` contains a negation and other words after it."""
        return at > 0 and self.words[at].text not in NEGATORS and self._is_denied_before(at)

    def is_denied_after(self, end: int) -> bool:
        """Return whether the words from position ``end`` deny the thing named directly before them, as in "is not visible"."""
        clause = self.words[end - 1].clause
        after = " ".join(w.text for w in self.words[end : end + 6] if w.clause == clause)
        return (
            bool(
                re.match(
                    r"(\w+ ){0,2}?(is|are|was|were|can|could) not ((currently|actually|now|yet|even|be|been|\w+ly) )?"
                    r"(visible|present|there|seen|found|shown|here|anywhere|be (seen|found)|"
                    r"in( \w+){0,3} (view|sight|picture|image|frame|photo|scene|preset)s?)\b"
                    rf"|{_ABSENCE_PREDICATE}|(is |are |was |were )?(none|no|0|zero)$|(can|is|are|does|do) not$",
                    after,
                )
            )
            or self.is_marked(end, ("no",))
            or is_listed_as_absent(self.words, end)
        )

    def is_marked(self, end: int, marks: Sequence[str]) -> bool:
        """Return whether the word at position ``end`` is one of the marks and stands alone, as in "drum (no)" and "drum: no"."""
        if end >= len(self.words) or self.words[end].text not in marks or not REMARK_SEPARATOR.search(self.words[end].gap):
            return False
        alone = end + 1 == len(self.words) or self.words[end + 1].segment != self.words[end].segment
        return alone or self.words[end + 1].gap.lstrip()[:1] in (")", "(", "|")

    def plain_text(self) -> str:
        """Return the words joined by spaces."""
        return " ".join(w.text for w in self.words)

    def segments(self) -> list[list[int]]:
        """Return the word positions of each segment."""
        return _positions_by_label([w.segment for w in self.words])

    def clauses(self) -> list[list[int]]:
        """Return the word positions of each clause."""
        return _positions_by_label([w.clause for w in self.words])


def _positions_by_label(labels: Sequence[int]) -> list[list[int]]:
    groups: dict[int, list[int]] = {}
    for position, label in enumerate(labels):
        groups.setdefault(label, []).append(position)
    return list(groups.values())


def answer_text(text: str) -> AnswerText:
    """Extract the statements from an answer.

    Questions, withdrawn statements, guesses and clauses that decline to answer are excluded.
    """
    cleaned = re.sub(r"\s*\(with [^()]*\)", "", replace_crosses(clean(text)))  # "white (with black letters)" means white
    cleaned = remove_withdrawn(cleaned)
    words = words_of(re.sub(r"[^.!?\n]*\?", "", cleaned))
    stating_words, declined, hedged = list[Word](), False, False
    for positions in _positions_by_label([w.clause for w in words]):
        clause = " ".join(words[i].text for i in positions)
        clause_words = [words[i] for i in positions]
        ends_of_refusals = [m.end() for m in _REFUSAL_PHRASES.finditer(clause)]
        if ends_of_refusals and not re.search(r"\bbut\b", clause[ends_of_refusals[-1] :]):
            declined = True
            last_word = clause[: ends_of_refusals[-1]].count(" ")
            stating_words += _premise(clause_words, last_word)
            stating_words += _reason(clause_words, last_word + 1)
        elif _HEDGES.search(clause):
            hedged = True
        else:
            stating_words += clause_words
    return AnswerText(tuple(stating_words), declined, hedged)


def remove_withdrawn(cleaned: str) -> str:
    """Remove everything up to the last correction ("scratch that", "I mean") from cleaned text."""
    return cleaned[max((match.end() for match in _CORRECTION.finditer(cleaned)), default=0) :]


def _premise(words: Sequence[Word], refusal: int) -> Sequence[Word]:
    """Return the words before ", so I cannot tell", or no words if the refusal is not a conclusion."""
    segment = words[refusal].segment
    start = next(at for at, word in enumerate(words) if word.segment == segment)
    return words[:start] if words[start].text in ("so", "therefore", "thus", "hence") else ()


def _reason(words: Sequence[Word], start: int) -> Sequence[Word]:
    """Return the words after "I cannot tell:" or "because", or no words if no reason is given."""
    reasons = (at for at in range(start, len(words)) if ":" in words[at].gap or words[at].text == "because")
    return words[next(reasons, len(words)) :]
