"""Split text into lexemes: known phrases, numbers and free words."""
