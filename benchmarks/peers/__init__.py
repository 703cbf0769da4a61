"""Run time against error, beside every tool that a user would pick instead, and the document of all measurements.

`sections` is the interface of a chapter, `document` writes `docs/performance.md` from what the chapters have stored.
"""
