"""Generation of further tasks: a language model drafts them, and only those that can be proved are kept.

``draft_prompt`` makes the request, with recorded ``operator_runs``, and ``draft_schema`` checks the reply. ``draft_places``
resolves the views of a draft, and ``answer_programs`` works out the right answer from the ground truth. ``drafting_loop`` repeats
this until there are enough tasks, and ``draft_ledger`` records the result for every draft.
"""
