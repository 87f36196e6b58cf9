"""Replace wordings of an instruction by plainer ones with the same meaning, before its clauses are read."""
