"""What users call. `differentiate` is the decorator, `drivers` have `gradient`, `vjp`, `jvp`,
`autodiff` is Enzyme's call; `pytrees/` takes structures apart before these and puts them together behind them.
"""
