#!/usr/bin/env bash
# tests.sh: `make test` on a fresh machine of a workflow, with what some tests need and otherwise skip without: off-screen
# OpenGL, bubblewrap with user namespaces, and a browser where the system has one. PYTHON names the interpreter.
set -euo pipefail
cd "$(dirname "$0")/.."
if command -v sudo >/dev/null && command -v apt-get >/dev/null; then
  sudo apt-get -qq update
  sudo DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends \
    libegl1 libgl1-mesa-dri bubblewrap openssl >/dev/null
  # Ubuntu keeps namespaces from programs without a profile; without them agents are held at L2 at most
  sudo sysctl -q -w kernel.apparmor_restrict_unprivileged_userns=0 || true
fi
make test
