"""What library functions are made of, where they have no rule of their own: one module for each topic."""
