"""Which questions a camera can answer at all, and which wishes it must refuse."""

from __future__ import annotations

import re

_ELSEWHERE = (
    "capital of", "president", "prime minister", "king of", "queen of", "meaning of life", "joke", "poem", "story", "song", "essay", "recipe",
    "cook", "bake", "movie", "film", "novel", "lyrics", "stock market", "share price", "bitcoin", "exchange rate", "square root", "plus", "multiplied", "divided by", "equation",
    "in the world", "world cup", "world war", "history of", "population of", "speed of light", "planet", "galaxy", "tomorrow", "yesterday", "next week", "last week", "last year", "forecast",
    "horoscope", "translate", "python code", "source code", "write code", "javascript", "email", "your name", "your favourite", "your favorite", "how old are you", "do you like", "do you love", "are you human", "are you sentient",
    "what time is it", "the time", "what day is it", "today's date", "what year is it", "what is the date", "who invented", "who wrote", "who discovered", "who won", "who painted", "who composed", "when was", "when did", "when were", "in french", "in german", "in spanish",
    "do i need", "should i", "tallest mountain", "largest country", "longest river", "biggest ocean", "my password", "my account", "my order", "credit card", "the internet", "google", "netflix", "facebook", "definition of", "explain how", "how do i", "how does one", "how do you make", "tell me about yourself", "news", "football match", "chemical", "quantum", "gravity", "photosynthesis", "moon landing",
)  # fmt: skip
_SUM = re.compile(r"\d\s*[-+*/×]\s*\d|\bwhat(?:'s| is) \d+\b")
_HARM = re.compile(
    r"\b(spy(?:ing)? on|stalk|peep|undress|naked|kill|shoot at|attack|murder|assassinate|rob the|break into|burgle|aim (?:the|a) (?:gun|weapon|rifle)|harass|blackmail|bomb the)\b|\b(bedroom|bathroom|changing room) window",
    re.IGNORECASE,
)
REFUSAL = "I will not help with that: this camera is not for harming or spying on people."


def is_about_the_scene(question: str) -> bool:
    """False for questions that no picture can answer."""
    text = " ".join(question.lower().replace("’", "'").split())
    return not (any(re.search(rf"\b{re.escape(phrase)}\b", text) for phrase in _ELSEWHERE) or _SUM.search(text))


def is_harmful(instruction: str) -> bool:
    return bool(_HARM.search(instruction))
