"""Sparse matrices of SciPy's: objects of the heap, and what is computed with them."""
