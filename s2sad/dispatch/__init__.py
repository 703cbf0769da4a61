"""One compiled derivative per types and constants. `arguments` describes a call's arguments, `cache` finds
or asks for the derivative that fits them, `executable` calls it; `artifacts` hands derivatives on to later processes.
"""
