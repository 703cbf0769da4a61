"""The tree becomes normal form: structured form first, then one operation per statement."""
from s2sad.normalize.structured import structured

__all__ = ["structured"]
