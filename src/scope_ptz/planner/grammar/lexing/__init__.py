"""Split an instruction into lexemes: words and fixed expressions with their classes, numbers and preset names."""
