#!/usr/bin/env bash
# Tamaas 2.9.0: the wheels for Python 3.13 and 3.14 install and then cannot be imported by an ordinary Python.
#
# Input:    the three wheels that pip takes for Python 3.12, 3.13 and 3.14.
# Expected: an extension module that the Python of the wheel's tag imports. A wheel with the tags cp313 and none says
#           that it fits every CPython 3.13; the ordinary one looks for modules that end in cpython-313-....so, abi3.so
#           or .so, and only the free-threaded one for cpython-313t-....so, which would have the tag cp313t.
# Seen:     so it is for 3.12. The other two wheels have nothing but a module for the free-threaded Python: pip installs
#           them without a word, and `import tamaas` raises ModuleNotFoundError: No module named 'tamaas._tamaas'.
# Exit:     0 if that is still so, 1 if the behaviour has changed.
#
# Any Python will do to look into the wheels; where it is an ordinary 3.13 or 3.14 (PYTHON names it), the import
# is tried too.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
for version in 3.12 3.13 3.14; do
  "$work/venv/bin/pip" download --quiet --disable-pip-version-check --no-deps --only-binary :all: \
    --python-version "$version" --dest "$work/wheels" tamaas==2.9.0
done
if "$work/venv/bin/python" -c 'import sys; sys.exit(sys.version_info[1] not in {13, 14} or "t" in sys.abiflags)'; then
  "$work/venv/bin/pip" install --quiet --disable-pip-version-check tamaas==2.9.0
fi
cd "$work"
"$work/venv/bin/python" - <<'PYTHON'
import importlib.util
import re
import subprocess
import sys
import zipfile
from pathlib import Path

seen = {}
for wheel in sorted(Path("wheels").glob("*.whl")):
    tag = re.search(r"-(cp\d+-\w+)-", wheel.name)[1]
    names = zipfile.ZipFile(wheel).namelist()
    seen[tag] = [re.search(r"cpython-(\w+)-", name)[1] for name in names if Path(name).name.startswith("_tamaas.")]
    print(f"wheel {tag}: expected a module for {tag[2:5]}, seen one for {seen[tag]}")
same = seen == {"cp312-none": ["312"], "cp313-none": ["313t"], "cp314-none": ["314t"]}
if importlib.util.find_spec("tamaas"):
    run = subprocess.run([sys.executable, "-c", "import tamaas"], capture_output=True, text=True)
    said = (run.stderr.splitlines() or ["nothing"])[-1]
    print("import tamaas: expected nothing, seen", said)
    same = same and said == "ModuleNotFoundError: No module named 'tamaas._tamaas'"
print("as described" if same else "CHANGED")
sys.exit(not same)
PYTHON
