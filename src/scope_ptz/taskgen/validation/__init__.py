"""Validation: proof that reference programs pass and adversarial answers fail."""
