"""infer: kind, dtype and rank of every name."""
