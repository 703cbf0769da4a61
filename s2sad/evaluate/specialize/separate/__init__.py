"""separate: functions that stay functions, beside the one that calls them.

`call_view` says what a function can see when it is called, `returned_parts` what it gives back, `needed_numbers` which
numbers it must know; `separate_call` evaluates it once for all calls that see the same, and calls what is left of it,
one of the `separate_functions`.
"""
from __future__ import annotations
