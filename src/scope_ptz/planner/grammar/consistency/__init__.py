"""Check that a plan accounts for every number, direction, preset and act of its instruction, independently of the parser."""
