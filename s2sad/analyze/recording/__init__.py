"""Recording: what of the kernel an adjoint reads, what of that comes back by itself, and the least that does not."""
