"""Split an instruction into clauses."""
