"""What every demo does with its results: `--out DIR`, a summary.json, pictures."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any


class Report:
    """The folder that a demo writes to, `--out DIR` or demos/out/<name of the demo>.

    quick: what `--quick` does, for a demo that has it; `self.quick` tells whether it was given.
    """

    def __init__(self, script: str, description: str, arguments: list[str] | None = None, quick: str = "") -> None:
        parser = argparse.ArgumentParser(description=description)
        default = Path(__file__).parent / "out" / Path(script).stem
        parser.add_argument("--out", type=Path, default=default, metavar="DIR", help="where the results go")
        if quick:
            parser.add_argument("--quick", action="store_true", help=quick)
        given = parser.parse_args(arguments)
        self.quick: bool = getattr(given, "quick", False)
        self.folder: Path = given.out
        self.folder.mkdir(parents=True, exist_ok=True)

    def path(self, name: str) -> Path:
        return self.folder / name

    def summary(self, values: Any) -> None:
        """Write the demo's numbers as JSON; NaN or infinity in them is an error, not a number."""
        self.path("summary.json").write_text(json.dumps(values, indent=1, allow_nan=False) + "\n")
        print(f"\nresults in {self.folder}")
