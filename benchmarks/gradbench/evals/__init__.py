"""GradBench's evals, one file each: `FUNCTIONS` has what an eval asks for by name."""
