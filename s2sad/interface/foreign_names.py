"""What other packages call something, and what to write here."""
from __future__ import annotations

from typing import NoReturn

_FUNCTIONS = {
    **dict.fromkeys(("derivative", "elementwise_grad"), 'write s2sad.gradient(f, wrt="x")'),
    **dict.fromkeys(("grad_and_value", "val_grad"), 'write s2sad.value_and_gradient(f, wrt="x")'),
    **dict.fromkeys(("jac", "jacrev", "jacfwd", "jacobi"), 'write s2sad.jacobian(f, wrt="x")'),
    **dict.fromkeys(("value_and_jac", "jacobian_and_value"), 'write s2sad.value_and_jacobian(f, wrt="x")'),
    **dict.fromkeys(("hess",), 'write s2sad.hessian(f, wrt="x")'),
    **dict.fromkeys(("hessian_vector_product", "vhp"), 'write s2sad.hvp(f, args, {"x": v})'),
    **dict.fromkeys(("jit", "njit", "compile"), "there is nothing to do: derivatives are compiled where Numba is "
                    "installed"),
    **dict.fromkeys(("vmap", "pmap", "batch"), 'write s2sad.batched(f, over="x")'),
    **dict.fromkeys(("stop_gradient", "detach", "no_grad"), "write s2sad.nondifferentiable(f), or leave it out of wrt"),
    **dict.fromkeys(("custom_vjp", "custom_jvp", "custom_gradient", "defvjp", "primitive", "register"),
                    "write s2sad.rule: partials, an adjoint, a tangent, or a residual"),
    **dict.fromkeys(("check_grads", "check_grad", "gradcheck", "approx_fprime"), "write s2sad.check(f, *args)"),
    **dict.fromkeys(("linearize", "pushforward", "forward"), "write s2sad.jvp(f, args, tangents)"),
    **dict.fromkeys(("pullback", "backward", "reverse"), "write s2sad.vjp(f, args, seeds)"),
    **dict.fromkeys(("pure_callback", "jax_callable", "to_jax", "as_jax"), "write s2sad.jax(f)"),
    **dict.fromkeys(("to_torch", "as_torch", "pytorch", "Function"), "write s2sad.torch(f)"),
    **dict.fromkeys(("numpy", "np"), "import numpy: kernels are written with NumPy itself"),
}
_KEYWORDS = {
    **dict.fromkeys(("argnums", "argnum", "inputs", "arg", "args", "x"),
                    'wrt: a name, wrt="x", a position, wrt=0, or several of them'),
    "has_aux": "a function that returns the one float, and the rest through an array that it writes",
    "holomorphic": "nothing: arguments may be complex, and f returns a float",
    "allow_int": "floats: an integer has no derivative",
    "create_graph": "nothing",
    "jit": 'engine="numba" of s2sad.differentiate',
}


def attribute(name: str) -> str:
    """The message of the AttributeError for a name that the package does not have."""
    known = f": {_FUNCTIONS[name]}" if name in _FUNCTIONS else ""
    return f"module 's2sad' has no attribute {name!r}{known}"


def unexpected_keywords(function: str, keywords: dict[str, NoReturn]) -> TypeError:
    """The error for keywords that a function does not have."""
    name = next(iter(keywords))
    known = f": write {_KEYWORDS[name]}" if name in _KEYWORDS else ""
    return TypeError(f"{function}() got an unexpected keyword argument '{name}'{known}")
