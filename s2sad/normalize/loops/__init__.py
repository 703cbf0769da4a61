"""Whole-array statements as loops over elements, and allocations outside of loops."""
