"""Calls with structures: taken apart into arrays and numbers at the door, and what comes back put together again."""
from s2sad.interface.pytrees.flat_selection import Carrier
from s2sad.interface.pytrees.flatten import Flattened, flatten, flat_call

__all__ = ["Carrier", "Flattened", "flatten", "flat_call"]
