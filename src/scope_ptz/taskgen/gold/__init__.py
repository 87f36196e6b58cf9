"""Gold runs: reference runs with one known fault each, which test the rules for error modes and the judges.

``agent_faults`` and ``reply_faults`` hold the faults, ``mutations`` puts one into a run, ``gold_runs`` makes, stores and scores
sets of such runs, and ``judge_results`` compares what LLM judges say about them with the known faults.
"""
