"""Programs of the simulation kind, written as their authors write NumPy, that must be differentiated as they are."""
