"""Parse English numerals, nouns, noun phrases and questions, for the built-in planner and for ground-truth perception.

The benchmark may import ``scope_ptz.english``, but not this package. Otherwise, a parsing error could affect both the benchmark
and the planner or perception that it measures, and remain unnoticed.
"""
