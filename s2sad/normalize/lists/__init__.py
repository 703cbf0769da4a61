"""Lists that grow: each becomes an array of its capacity, with its length."""
