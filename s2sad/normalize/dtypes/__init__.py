"""Dtypes: what NumPy's promotion, Python's numbers and fixed width integers ask for, made explicit or refused."""
