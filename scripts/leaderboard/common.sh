# What the leaderboard's scripts share: strictness, the repository's root, and how hthor is called. To be sourced.
set -euo pipefail
ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
PYTHON=${PYTHON:-$ROOT/.venv/bin/python}
[ -x "$PYTHON" ] || PYTHON=$(command -v python3)

hthor() { PYTHONPATH="$ROOT" "$PYTHON" -m hthor "$@"; }

usage() {
  sed -n '2,/^[^#]/{s/^# //p}' "$0" >&2
  exit 2
}
