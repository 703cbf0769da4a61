"""Tape entries: which of them take less memory than what they hold, and why that is enough."""
