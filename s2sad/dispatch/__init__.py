"""One compiled derivative per types and constants. `arguments` describes a call's arguments, `cache` finds
or derives the one that fits them, `executable` calls it; `artifacts` keeps derivatives on disk for later processes.
"""
