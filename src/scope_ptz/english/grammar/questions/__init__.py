"""The grammar and meaning of noun phrases ("the second red car from the left") and of questions about a picture.

``question_parser`` parses them into the data classes of ``question_tree``. ``recognition`` only tests whether a text is a noun
phrase, which takes less time and memory.
"""
