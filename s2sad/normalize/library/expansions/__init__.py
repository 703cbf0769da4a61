"""Functions of whole arrays as functions that have a rule, slices and loops: `EXPANSIONS` of each module, by name."""
