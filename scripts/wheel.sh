#!/usr/bin/env bash
# wheel.sh [FOLDER]: builds the wheel and the sdist into FOLDER (default: a temporary one) and tries them without the source
# tree: the wheel has every file of hthor/ that git tracks and the built page, the sdist builds a wheel with the same files, and in an empty
# environment, called from an empty folder, the wheel passes `hthor doctor`, plays a few trials, and imports every module.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
python=$root/.venv/bin/python
[ $# -le 1 ] || { sed -n '2,/^[^#]/{s/^# //p}' "$0" >&2; exit 2; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
out=${1:-$work/dist}
mkdir -p "$out"
out=$(cd "$out" && pwd)

# A list of "hash path" of everything in a wheel but its own RECORD, which lists the same.
contents() {
  "$python" - "$1" <<'PY'
import hashlib
import sys
import zipfile

with zipfile.ZipFile(sys.argv[1]) as wheel:
    for name in sorted(wheel.namelist()):
        if not name.endswith(("/", ".dist-info/RECORD")):
            print(hashlib.sha256(wheel.read(name)).hexdigest(), name)
PY
}

make --silent -C "$root" .venv/.installed-dev page

echo "-- build the sdist and the wheel"
mkdir "$work/tree"
(cd "$root" && git ls-files -z | xargs -0 ls -d 2>/dev/null | tar -cf - -T -) | tar -xf - -C "$work/tree"
cp -r "$root/hthor/live/page" "$work/tree/hthor/live/page"
"$python" -m build --outdir "$out" --sdist --wheel "$work/tree" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
sdist=$(ls "$out"/hthor-*.tar.gz) wheel=$(ls "$out"/hthor-*.whl)

echo "-- every tracked file of hthor/ is in the wheel, and nothing else"
contents "$wheel" >"$work/wheel.txt"
(cd "$work/tree" && find hthor -type f | sort) >"$work/tracked"
cut -d' ' -f2 "$work/wheel.txt" | grep -v '^hthor-' | sort >"$work/packed"
diff "$work/tracked" "$work/packed" || { echo "the wheel differs from the source tree: see [tool.setuptools] in pyproject.toml" >&2; exit 1; }

echo "-- no private key is among the files that are packed"
keys=$(grep -rlE -e '-----BEGIN [A-Z ]*PRIVATE KEY' "$work/tree" || true)
[ -z "$keys" ] || { echo "a private key is in the source tree: $keys" >&2; exit 1; }

echo "-- the sdist builds the same wheel"
mkdir "$work/unpacked" "$work/again"
tar -xzf "$sdist" -C "$work/unpacked" --strip-components=1
"$python" -m build --outdir "$work/again" --wheel "$work/unpacked" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
contents "$work"/again/*.whl | diff "$work/wheel.txt" -

echo "-- install the wheel in an empty environment and use it from an empty folder"
"$python" -m venv "$work/env"
"$work/env/bin/python" -m pip install --quiet --disable-pip-version-check -c "$root/constraints.txt" "$wheel"
mkdir "$work/empty"
cd "$work/empty"
unset PYTHONPATH
PATH=$work/env/bin:$PATH
hthor agent new my_agent.py
hthor eval --agent my_agent.py --agent frontier --humans proxy --limit 3 --quiet
hthor eval --robots tall:oracle,small:frontier --kind collect --limit 2 --quiet
hthor report runs/my_agent-smoke-* runs/frontier-smoke-* --out report
hthor doctor
"$work/env/bin/python" - "$work/env" <<'PY'
import pathlib
import sys

import hthor

here = pathlib.Path(hthor.__file__).resolve()
sys.exit(None if pathlib.Path(sys.argv[1]).resolve() in here.parents else f"hthor came from {here}, not from the wheel")
PY

echo "-- every module can be imported with what the wheel requires, or names the extra that it needs"
"$work/env/bin/python" - <<'PY'
import importlib
import pkgutil

import hthor
from hthor.errors import MissingExtra

# A package that needs an extra says so when it is imported, for all of its modules.
names = [module.name for module in pkgutil.walk_packages(hthor.__path__, "hthor.", onerror=lambda name: None)]
without = []
for name in names:
    if not name.endswith("__main__"):
        try:
            importlib.import_module(name)
        except MissingExtra as error:
            without.append(f"{name}: {error}")
print(len(names) - len(without), "modules")
print(*without, sep="\n")
PY
