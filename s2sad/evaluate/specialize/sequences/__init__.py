"""Lists, dicts, sets, and what is gone through."""
