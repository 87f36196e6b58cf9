"""Parse an agent's free-text answer into a typed value and compare it with a task's expected answer.

Import from this package only; its modules are internal. ``parse_answer`` and ``agrees`` are the entry points. The
other functions find words and numbers in other texts, such as tool results and tool arguments.

The parser shares no code with the planner's grammar or with the description parser of ground-truth perception, so an error in one
of them cannot hide an error in another.
"""

from scope_ptz.bench.answers.helpers import is_stated, numbers_in
from scope_ptz.bench.answers.parsed import Declined, ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.parser import agrees, parse_answer
from scope_ptz.bench.answers.strings import TEXT_SEPARATOR, normalized_text, same_text
from scope_ptz.bench.answers.tokenizer import all_wordings, names_any, plain_words

__all__ = [
    "TEXT_SEPARATOR",
    "Declined",
    "ParsedAnswer",
    "ParsedValue",
    "Unreadable",
    "agrees",
    "all_wordings",
    "is_stated",
    "names_any",
    "normalized_text",
    "numbers_in",
    "parse_answer",
    "plain_words",
    "same_text",
]
