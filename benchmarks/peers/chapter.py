"""`python -m benchmarks.peers.chapter NAME FILE [quick]` measures one chapter and stores it as JSON; where the file is
there it completes that."""
from __future__ import annotations

import json
import sys
from datetime import date
from pathlib import Path

from benchmarks.peers.sections import section


def main(name: str, path: Path, quick: bool) -> None:
    """Writes the file at once when all is measured: a file that is there is whole."""
    found = section(name)
    assert found is not None
    made = found.resume(json.loads(path.read_text())) if found.resume and path.exists() else found.measure(quick)
    made.setdefault("date", date.today().isoformat())
    text = json.dumps(made, indent=1)
    unfinished = path.with_suffix(".part")
    unfinished.write_text(text)
    unfinished.replace(path)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), "quick" in sys.argv[3:])
