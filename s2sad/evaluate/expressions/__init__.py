"""Expressions and assignments: tuples, tables, slices, options and questions about types are written out."""
