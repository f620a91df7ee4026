#!/usr/bin/env bash
# setup.sh [dev]: makes a fresh machine ready: bubblewrap with user namespaces, for isolation L3, and hthor in its own
# environment, every package by its hash. With dev it is the environment of `make test` instead, where no secret is near.
source "$(dirname "$0")/common.sh"
[ $# = 0 ] || [ "$*" = dev ] || usage
if command -v sudo >/dev/null; then
  sudo apt-get -qq update
  sudo DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends bubblewrap openssl >/dev/null
  # Ubuntu keeps namespaces from programs without a profile; without them agents are held at L2 at most
  sudo sysctl -q -w kernel.apparmor_restrict_unprivileged_userns=0 || true
fi
if [ "${1:-}" = dev ]; then
  make -C "$ROOT" .venv/.installed-dev
else
  make -C "$ROOT" .venv/bin/python
  pip=("$ROOT/.venv/bin/python" -m pip install --quiet --disable-pip-version-check)
  "${pip[@]}" --require-hashes --only-binary :all: -r "$ROOT/scripts/leaderboard/requirements.txt"
  "${pip[@]}" --no-deps --no-build-isolation -e "$ROOT"
fi
