"""Structures (records, dictionaries, lists) become their arrays and numbers."""
