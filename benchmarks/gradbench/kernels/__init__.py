"""The objectives of GradBench's evals as plain NumPy, one file an eval; every derivative is made of these."""
