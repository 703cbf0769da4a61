"""Classes: where their names are found, what decorators and bases make of them, their objects."""
