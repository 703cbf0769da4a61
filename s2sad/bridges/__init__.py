"""Kernels as differentiable functions of other packages: of JAX's in `jax_functions`, of PyTorch's in
`torch_functions`, of CasADi's in `casadi_functions`.

`bridged_kernel` runs a kernel and its derivatives on values of NumPy's and never writes what it is given; `xla_calls`,
`xla_handlers` and `xla_frames` have XLA call the compiled ones.
"""
