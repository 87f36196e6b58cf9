"""Parse English noun phrases ("the second red car from the left") and questions about a picture to plain data."""

from scope_ptz.perception.ground_truth.language.question_parser import is_description, parse_description, parse_question

__all__ = ["is_description", "parse_description", "parse_question"]
