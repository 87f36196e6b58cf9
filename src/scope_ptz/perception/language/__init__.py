"""English about pictures: noun phrases ("the second red car from the left") and questions, parsed to plain data."""

from scope_ptz.perception.language.parse import parse_description, parse_question

__all__ = ["parse_description", "parse_question"]
