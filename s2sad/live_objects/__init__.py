"""live_objects: what Python's live objects hold. `guards` takes values from them and compares them at later calls,
`unwrap` finds the function behind a wrapper, `code_text` the text that its code was compiled from, `registry` has the
functions with a derivative of the user's own, and `side_table` keeps what was derived of a function on the function
itself.
"""
