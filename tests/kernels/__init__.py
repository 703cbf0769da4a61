"""Kernels as simulation people write them, and inputs for them (`cases`)."""
