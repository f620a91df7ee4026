#!/usr/bin/env bash
# The oldest dm-control that pyproject.toml allows: the world is bit for bit the same with it, and a trial is a composer
# environment. The newest is the one that is installed.
set -euo pipefail
cd "$(dirname "$0")/.."
oldest=$(sed -n 's/.*"dm-control>=\([0-9.]*\),.*/\1/p' pyproject.toml)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
.venv/bin/python -m pip install --quiet --no-deps --target "$folder" "dm-control==$oldest"
PYTHONPATH="$folder" .venv/bin/python -c "
from importlib.metadata import version
assert version('dm_control') == '$oldest', version('dm_control')"
PYTHONPATH="$folder" .venv/bin/pytest -q tests/world/test_golden.py tests/envs/test_composer_trial.py -m "not nightly"
