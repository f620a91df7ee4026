#!/usr/bin/env bash
# docs.sh: builds the documentation site and runs its notebook; any warning is an error.
set -euo pipefail
cd "$(dirname "$0")/.."
make docs
