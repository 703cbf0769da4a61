"""evaluate: what is known before types are is computed here.

In comes the tree of a kernel with resolved names, in the supported subset of Python; out goes one in which structures
are arrays and numbers, options are constants, and loops go through ranges. Programs that are made of more than arrays
and numbers (`needs_evaluation`) are evaluated (`specialize`); what the passes of `normalize` ask of a kernel that has
no types yet is here as well: its scope, what its statements write, where its blocks end.
"""
