"""Numbers of bytes, in words."""
from __future__ import annotations


def byte_text(count: int) -> str:
    """A number of bytes, in MB from a tenth of one on.

    >>> byte_text(2880), byte_text(8_000_000), byte_text(1_234_567_890)
    ('2,880 bytes', '8.00 MB', '1,235 MB')
    """
    if count < 100_000:
        return f"{count:,} bytes"
    return f"{count / 1e6:,.{max(0, 9 - len(str(count)))}f} MB" if count >= 1_000_000 else f"{count / 1e6:.2f} MB"
