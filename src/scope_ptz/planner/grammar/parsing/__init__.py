"""Read the clauses of an instruction and combine them into steps."""
