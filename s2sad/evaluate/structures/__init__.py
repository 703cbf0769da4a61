"""Structures (records, dictionaries, lists, sparse matrices) become their arrays and numbers."""
