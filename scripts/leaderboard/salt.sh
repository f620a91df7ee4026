#!/usr/bin/env bash
# salt.sh FILE: writes the salt to a file that only this user can read; from HTHOR_SALT if that is set, else from
# standard input. It goes no further: no agent runs in a step that has it.
source "$(dirname "$0")/common.sh"
[ $# = 1 ] || usage
umask 077
if [ -n "${HTHOR_SALT:-}" ]; then printf '%s\n' "$HTHOR_SALT" >"$1"; else cat >"$1"; fi
unset HTHOR_SALT
[ -s "$1" ] || { echo "there is no salt; is the secret HTHOR_SALT set in this environment?" >&2; exit 2; }
