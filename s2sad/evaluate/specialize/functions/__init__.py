"""Functions of libraries over what is known."""
