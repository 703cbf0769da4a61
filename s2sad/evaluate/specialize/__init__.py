"""specialize: what is known before the run is computed, by one evaluator with a transfer function for each construct.

In comes the text of a function with what its arguments are made of; out goes a residual function over arrays and
numbers, which is read as any other. `evaluator` has the state and the tables; `values` and `heap` what is known;
`control` where the program goes on; `live_values` what comes from outside; `separate` the functions that stay
functions.
"""
from __future__ import annotations

# the tables of transfer functions and operations are filled by these
from s2sad.evaluate.specialize import (
    assignment, attributes, comparisons, definitions, displays, file_values, frames, function_calls, live_values,
    meanings, numeric_operators, shape_changes, spelling, subscripts,
)
from s2sad.evaluate.specialize.classes import (
    attribute_dictionary, class_attributes, class_layout, class_lookup, construction,
)
from s2sad.evaluate.specialize.control import (
    branches, choices, compound_statements, guard_statements, loop_statements, residual_loops, while_statements,
    written_out_loops,
)
from s2sad.evaluate.specialize.entry import Residual, specialize, unread
from s2sad.evaluate.specialize.functions import (
    builtin_functions, library_calls, object_functions, ordering, standard_library, vectorized_functions,
    written_functions,
)
from s2sad.evaluate.specialize.separate import derivative_calls, separate_call
from s2sad.evaluate.specialize.sparse import matrix_construction, matrix_operations, matrix_values
from s2sad.evaluate.specialize.sequences import (
    constant_tables, container_methods, containers, cursors, gathering, generators, iteration, iterator_use,
    listed_records, nested_ranges, residual_lists, shared_rows,
)

__all__ = [
    "Residual", "assignment", "attribute_dictionary", "attributes", "branches", "builtin_functions", "choices",
    "class_attributes", "class_layout", "class_lookup", "comparisons", "compound_statements", "constant_tables",
    "construction", "container_methods", "containers", "cursors", "definitions", "derivative_calls", "displays",
    "file_values", "frames", "function_calls", "gathering", "generators", "guard_statements", "iteration",
    "iterator_use", "library_calls", "listed_records", "live_values", "loop_statements", "matrix_construction",
    "matrix_operations", "matrix_values", "meanings", "nested_ranges", "numeric_operators", "object_functions",
    "ordering", "residual_lists", "residual_loops", "separate_call", "shape_changes", "shared_rows", "specialize",
    "spelling", "standard_library", "subscripts", "unread", "vectorized_functions", "while_statements",
    "written_functions", "written_out_loops",
]
