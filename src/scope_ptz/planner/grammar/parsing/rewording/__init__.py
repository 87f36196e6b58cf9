"""Replace wordings in an instruction with plainer ones of the same meaning, before its clauses are read."""
