"""s2sad as a tool of GradBench: `python -m benchmarks.gradbench` answers the messages of an eval.

`protocol` speaks, `evals` has one file for each eval with what its functions read, call and give back, `kernels` their
objectives as plain NumPy, `inputs` the evals' generators, `cpp` the same by hand, `measure` both in turns.
"""
