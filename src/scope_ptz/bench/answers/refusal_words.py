"""Words that do not name the subject of a refusal, as in "I cannot tell how many of them there are"."""

from __future__ import annotations

COMMON_WORDS = frozenset({
    "a", "an", "the", "this", "that", "these", "those", "it", "its", "them", "they", "their", "i", "we", "you", "me", "my",
    "your", "he", "she", "one", "any", "some", "all", "each", "both", "either", "neither", "myself", "is", "are", "was", "were",
    "be", "been", "being", "am", "has", "have", "had", "do", "does", "did", "can", "could", "will", "would", "may", "might",
    "must", "should", "not", "no", "and", "or", "of", "in", "on", "at", "to", "for", "from", "with", "by", "as", "so", "if",
    "than", "then", "there", "here", "where", "how", "many", "much", "which", "what", "whether", "out", "now", "yet", "still",
    "also", "too", "but", "really", "actually", "clearly", "exactly", "reliably", "certainly", "definitely", "honestly",
    "honest", "unfortunately", "sorry", "afraid", "however", "though", "although", "just", "only", "even", "ever", "far", "sure",
    "certain", "true", "correct", "question", "answer", "result", "value", "ai", "language", "model", "assistant", "image",
    "images", "picture", "pictures", "photo", "photos", "scene", "frame", "video", "feed", "view", "views", "camera", "tool",
    "tools", "perception", "call", "calls", "detector", "eyes", "ability", "information", "data", "access", "response", "reply",
    "output", "evidence", "anything", "something", "else", "enough", "well", "way", "tell", "say", "know", "see", "look",
    "looked", "about", "regarding", "reported", "returned", "loaded", "count", "counted", "number", "amount", "quantity",
    "total", "determine", "read", "answered", "right", "wrong", "please", "because", "since", "while", "currently", "present",
    "visible", "available", "unavailable", "failed", "error", "take", "word", "put", "simply", "frankly", "truly", "none",
    "zero", "nothing", "yes", "0", "go", "moment", "today", "possible", "able", "given", "need",
})  # fmt: skip
"""Words that do not name a subject in answers to any question."""

WORDS_BY_KIND: dict[str, frozenset[str]] = {
    "choice": frozenset({
        "colour", "shade", "side", "part", "position", "place", "half", "quarter", "more", "most", "fewer", "least", "option",
        "difference",
    }),
    "text": frozenset({
        "text", "sign", "signs", "says", "writing", "written", "words", "letters", "price", "plate", "number", "board", "label",
        "name", "lettering",
    }),
    "ordering": frozenset({
        "order", "distance", "distances", "nearest", "farthest", "closest", "position", "ranking", "rank", "compare", "more",
        "most",
    }),
    "relation": frozenset({
        "more", "fewer", "less", "most", "same", "difference", "compare", "comparison",
    }),
    "number": frozenset({
        "count", "counts", "number", "sum", "difference",
    }),
}  # fmt: skip
"""Additional words that do not name a subject, by kind of expected answer, such as "colour" for a choice."""
