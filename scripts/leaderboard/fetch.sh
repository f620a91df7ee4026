#!/usr/bin/env bash
# fetch.sh COMMIT FOLDER: puts a submission's FOLDER as it is in COMMIT, and nothing else of it, into this checkout.
# To be called in the repository.
source "$(dirname "$0")/common.sh"
[ $# = 2 ] || usage
[[ $1 =~ ^[0-9a-f]{40}$ ]] || { echo "COMMIT must be a full hash, got '$1'" >&2; exit 2; }
[[ $2 =~ ^submissions/[a-z0-9][a-z0-9_-]{0,39}$ ]] || { echo "FOLDER must be submissions/NAME, got '$2'" >&2; exit 2; }
git cat-file -e "$1^{commit}" 2>/dev/null || git fetch -q origin "$1"
rm -rf "./$2"
git checkout -q "$1" -- "$2"
