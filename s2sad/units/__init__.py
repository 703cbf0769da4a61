"""Units: the kernels of a program in normal form, one per set of argument types, and their derivatives, each made once.

A unit's summary says what a call of it writes, what depends on what, and whether it may be left out.
"""
from s2sad.units.derivatives import Derived, Units
from s2sad.units.unit import Summary, Unit

__all__ = ["Derived", "Summary", "Unit", "Units"]
