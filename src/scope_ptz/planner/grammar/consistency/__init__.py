"""Check that a plan accounts for every number, direction, preset and action of its instruction, independently of the parser."""
