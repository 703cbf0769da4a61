"""units: the kernels of a program in normal form, one per set of argument types, and their derivatives, each made once.

In comes a program; out go units on demand: KERNELS is what runs on a kernel, the phases of `normalize` with what
`optimize` does before a kernel is differentiated; DERIVATIVES, the lists of `analyze` and `differentiate`, make a
derivative of it, which `simplify`'s lists shorten. A unit's summary says what
a call of it writes, what depends on what, and whether it may be left out.
"""
from s2sad.units.named_loops import Place, check_outlined, loops_that_keep, user_names
from s2sad.units.normal_forms import KERNELS
from s2sad.units.unit import UnitSummary, Unit
from s2sad.units.unit_derivatives import DERIVATIVES, UnitDerivative, Units

__all__ = ["DERIVATIVES", "KERNELS", "Place", "Unit", "UnitDerivative", "UnitSummary", "Units", "check_outlined",
           "loops_that_keep", "user_names"]
