#!/usr/bin/env bash
# unseal.sh SALT_FILE SEALED...: unpacks into this folder what seal.sh packed, then forgets the salt.
source "$(dirname "$0")/common.sh"
[ $# -ge 2 ] || usage
key=$1
shift
for sealed in "$@"; do openssl enc -d -aes-256-cbc -pbkdf2 -pass "file:$key" -in "$sealed" | tar -x; done
[ -n "${KEEP_SALT:-}" ] || rm -f "$key"
