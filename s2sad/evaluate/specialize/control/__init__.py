"""control: what Python does next: branches and where their ways join, loops that stay and loops that are written out.

In comes a statement with its frame; the state of the evaluation goes on behind it, or `Leave` says where to.
"""
