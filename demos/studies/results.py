"""What every demo and study does with its results: `--out DIR`, a summary.json, pictures."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path
from typing import Any

DEMOS = Path(__file__).resolve().parents[1]
#: The gmsh scripts that the demos mesh.
MESHES = DEMOS.parent / "meshes"


class Report:
    """The folder that a demo writes to, `--out DIR` or demos/out/<name of the demo> (CONTACTDD_DEMOS_OUT/<name>).

    script: the demo's path or name; description: what `--help` says; quick: what `--quick` does, for a study that has
    it; `self.quick` tells whether it was given. In a notebook, which has no command line, nothing is read from it.
    """

    def __init__(
        self, script: str, description: str | None, arguments: list[str] | None = None, quick: str = ""
    ) -> None:
        parser = argparse.ArgumentParser(description=description)
        default = Path(os.environ.get("CONTACTDD_DEMOS_OUT", DEMOS / "out")) / Path(script).stem
        parser.add_argument("--out", type=Path, default=default, metavar="DIR", help="where the results go")
        if quick:
            parser.add_argument("--quick", action="store_true", help=quick)
        given = parser.parse_args([] if arguments is None and _in_notebook() else arguments)
        self.quick: bool = getattr(given, "quick", False)
        self.folder: Path = given.out
        self.folder.mkdir(parents=True, exist_ok=True)

    def path(self, name: str) -> Path:
        return self.folder / name

    def summary(self, values: Any) -> None:
        """Write the demo's numbers as JSON; NaN or infinity in them is an error, not a number."""
        self.path("summary.json").write_text(json.dumps(values, indent=1, allow_nan=False) + "\n")
        print(f"\nresults in {self.folder}")


def _in_notebook() -> bool:
    import __main__

    return not hasattr(__main__, "__file__") or "ipykernel" in str(__main__.__file__)
