"""Buffers: which array every name is a part of, through rebindings, branches, loops and swaps."""
