#!/usr/bin/env bash
# Makes a fresh machine ready: bubblewrap with user namespaces, for isolation L3, and hthor in its own environment.
source "$(dirname "$0")/common.sh"
if command -v sudo >/dev/null; then
  sudo apt-get -qq update
  sudo DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends bubblewrap openssl >/dev/null
  # Ubuntu keeps namespaces from programs without a profile; without them agents are held at L2 at most
  sudo sysctl -q -w kernel.apparmor_restrict_unprivileged_userns=0 || true
fi
make -C "$ROOT" .venv/.installed-dev
