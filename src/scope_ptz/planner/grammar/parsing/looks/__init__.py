"""Read clauses that ask perception or take pictures: counts, questions, close-ups, comparisons."""
