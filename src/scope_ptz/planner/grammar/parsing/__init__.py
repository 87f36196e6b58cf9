"""Parse lexemes into the steps of an instruction: grammar, chart parser and builders."""
