"""Gold runs: reference runs with one known fault each, which test the rules for error modes and the judges.

``agent_faults`` and ``reply_faults`` define the faults, and ``mutations`` inserts one into a run. ``gold_runs`` creates, stores and
scores sets of gold runs. ``judge_results`` compares the verdicts of LLM judges with the known faults.
"""
