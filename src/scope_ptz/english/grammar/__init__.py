"""Understand English: numerals and nouns, for the built-in planner and for ground-truth perception.

The benchmark may import the words of ``scope_ptz.english``, but not this package, because it must not share mistakes of
understanding with what it measures.
"""
