"""Generate additional tasks. A language model drafts them, and only drafts that pass validation are kept.

``draft_prompt`` writes the request, which includes recorded ``operator_runs``, and ``draft_schema`` validates the reply.
``draft_places`` resolves the views of a draft, and ``answer_programs`` computes the correct answer from the ground truth.
``run_drafts`` converts recorded runs to drafts of the same format, and ``run_draft_file`` validates a file of them.
``drafting_loop`` requests and validates drafts until there are enough tasks, and ``draft_ledger`` records every result.
"""
