"""Find the remarks in an instruction, which ask for nothing: by their forms, and with a linear model."""
