#!/usr/bin/env bash
# unseal.sh SALT_FILE KIND SEALED...: unpacks into this folder what seal.sh packed, then forgets the salt. KIND is suite,
# control or shard: only the files that such a thing has are taken, and only when they are plain files of a possible size.
source "$(dirname "$0")/common.sh"
[ $# -ge 3 ] || usage
key=$1 kind=$2
shift 2
empty=$(mktemp -d)
trap 'rm -rf "$empty"' EXIT
for sealed in "$@"; do
  "$PYTHON" "$ROOT/scripts/leaderboard/parcel.py" check "$key" "$sealed" "$empty/body"
  mkdir "$empty/out"
  openssl enc -d -aes-256-cbc -pbkdf2 -pass "file:$key" -in "$empty/body" |
    "$PYTHON" "$ROOT/scripts/leaderboard/parcel.py" unpack "$kind" "$empty/out"
  "$PYTHON" "$ROOT/scripts/leaderboard/parcel.py" move "$empty/out" .
  rm -r "$empty/out" "$empty/body"
done
[ -n "${KEEP_SALT:-}" ] || rm -f "$key"
