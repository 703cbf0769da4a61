"""`runtime.lanes` for compiled code: memory on the stack of a function, which LLVM keeps in registers if it can."""
from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any


def lanes_on_stack(numba: Any) -> Callable[..., Any]:
    """The function for Numba. Its width is a constant of the text; what it gives must not outlive its function."""
    cgutils, arrays, declarations = (importlib.import_module(f"numba.{part}") for part in (
        "core.cgutils", "np.arrayobj", "core.typing.npydecl"))
    types = numba.core.types

    def lanes(context: Any, width: Any, dtype: Any = None):
        number = types.float64 if dtype is None else declarations.parse_dtype(dtype)
        count, made = width.literal_value, types.Array(number, 1, "C")

        def generated(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            kind = context.get_data_type(number)
            memory = cgutils.alloca_once(builder, kind, size=count)
            size = context.get_constant(types.intp, context.get_abi_sizeof(kind))
            array = arrays.make_array(made)(context, builder)
            arrays.populate_array(array, data=memory, shape=[context.get_constant(types.intp, count)], strides=[size],
                                  itemsize=size, meminfo=None)
            return array._getvalue()
        return made(width, types.Omitted(None) if dtype is None else dtype), generated
    return numba.extending.intrinsic(prefer_literal=True)(lanes)
