"""The kernels that are measured, as their users would have written them, and their sizes."""
