"""What stands beside a differentiated function under its name: the adjoint, and its first half."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

from s2sad.interface.tapes import Tape
from s2sad.run.memory import Memory
from s2sad.run.tracebacks import public, shortened

if TYPE_CHECKING:
    from s2sad.interface.differentiate import Differentiated


class Adjoint:
    """The adjoint of a differentiated function."""
    __slots__ = ("_function",)

    def __init__(self, function: Differentiated[Any, Any]):
        self._function = function

    def __call__(self, *args: Any) -> Any:
        """The adjoints of the float scalar arguments as a tuple, in order (None without any); shadows in place.

        Args: f's arguments, each followed by its shadow (same shape and dtype, writeable) if it has one, then the
        seeds of the float results. Raises S2sadError, before anything is written: S403 (a shadow that does not fit),
        S404 (memory shared), S405 (an argument that does not fit); and what f raises.
        """
        try:
            return self._function._shadowed("adjoint", args)
        except Exception as error:
            outside = shortened(error)
        raise outside

    @public
    def memory(self, *args: Any, **keywords: Any) -> Memory:
        """The memory that the adjoint takes for these arguments, f's own, without shadows, found before anything runs:
        see `Memory`. Raises S2sadError as a call does.

        >>> import numpy as np
        >>> from s2sad import differentiate
        >>> @differentiate(wrt="u", engine="numpy")
        ... def steps(u, n: int):
        ...     for k in range(n):
        ...         for i in range(u.size):
        ...             u[i] = u[i] * u[i]
        >>> print(steps.adjoint.memory(np.ones(100), 1000))
        0.80 MB beside the arguments
          tape: 0.80 MB
        """
        return self._function._memory(args, keywords)

    def __repr__(self) -> str:
        return f"<adjoint of {self._function.__wrapped_kernel__.__name__}>"


class AugmentedPrimal:
    """The first half of the adjoint of a differentiated function; `reverse` is the second."""
    __slots__ = ("_function",)

    def __init__(self, function: Differentiated[Any, Any]):
        self._function = function

    @public
    def __call__(self, *args: Any, **keywords: Any) -> tuple[Any, Tape]:
        """What f returns, and the tape of its forward sweep; arguments are written as f writes them.

        Args: f's own. The tape holds all that reverse sweeps read, in memory of its own: arguments and results may be
        written right away. Raises S2sadError, before anything is written: S404, S405 as `adjoint`, S409 (f leaves
        another object in an argument); and what f raises. Moses and Churavy, NeurIPS 2020.

        >>> import numpy as np
        >>> from s2sad import differentiate
        >>> @differentiate(wrt="u", engine="numpy")
        ... def square(u):
        ...     u[:] = u * u
        >>> u, u_bar = np.array([1.0, 3.0]), np.ones(2)
        >>> result, tape = square.augmented(u)
        >>> square.reverse(tape, u_bar), u, u_bar
        (None, array([1., 9.]), array([2., 6.]))
        """
        return self._function._run_augmented(args, keywords)

    @public
    def memory(self, *args: Any, **keywords: Any) -> Memory:
        """The memory that both halves take for these arguments, the tape between them with it, found before anything
        runs: see `Memory`. A sweep that keeps the tape takes copies beside it. Raises S2sadError as a call does.

        >>> import numpy as np
        >>> from s2sad import differentiate
        >>> @differentiate(wrt="u", engine="numpy")
        ... def steps(u, n: int):
        ...     for k in range(n):
        ...         u[:] = u * u
        >>> print(steps.augmented.memory(np.ones(100), 1000))
        0.80 MB beside the arguments
          tape: 0.80 MB
          other arrays: 2,400 bytes
        """
        return self._function._memory(args, keywords, split=True)

    def __repr__(self) -> str:
        return f"<augmented primal of {self._function.__wrapped_kernel__.__name__}>"
