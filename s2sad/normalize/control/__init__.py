"""Control flow: one exit, return variables, peeled iterations, conditional values."""
