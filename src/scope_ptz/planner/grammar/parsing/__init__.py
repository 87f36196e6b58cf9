"""From lexemes to the steps of an instruction: grammar, chart parser and builders."""
