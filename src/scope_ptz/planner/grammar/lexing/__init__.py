"""From text to lexemes: known phrases, numbers and free words."""
