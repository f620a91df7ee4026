#!/usr/bin/env bash
# seal.sh SALT_FILE OUT FOLDER...: packs folders of a secret suite for another job, encrypted and authenticated with the
# salt; artifacts can be read by others.
source "$(dirname "$0")/common.sh"
[ $# -ge 3 ] || usage
key=$1 out=$2
shift 2
tar -c -- "$@" | openssl enc -aes-256-cbc -pbkdf2 -salt -pass "file:$key" -out "$out.part"
"$PYTHON" "$ROOT/scripts/leaderboard/parcel.py" sign "$key" "$out.part"
mv "$out.part" "$out"
