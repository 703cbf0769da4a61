def tables(quick, kernels):
    return []
