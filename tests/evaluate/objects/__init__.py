"""Objects, lists, dicts and functions as values, which the evaluator computes before the run."""
