"""Control flow: one target a statement, one exit, loops that count, return variables, peeled iterations."""
