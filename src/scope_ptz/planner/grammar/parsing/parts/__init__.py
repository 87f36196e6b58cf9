"""The parts of clauses: words and their patterns, names of presets, descriptions, scopes of views and forms of questions."""
