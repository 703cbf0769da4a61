"""Ordinary differential equations whose right-hand side is a kernel: what SciPy's integrators take, and gradients of
what comes of their solutions."""
