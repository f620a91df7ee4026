#!/usr/bin/env bash
# changed.sh BASE HEAD: prints the one submission that the commits from BASE to HEAD hand in. Fails when they touch
# anything else. To be called in the repository.
source "$(dirname "$0")/common.sh"
[ $# = 2 ] || usage
git cat-file -e "$2^{commit}" 2>/dev/null || git fetch -q origin "$2"
paths=$(git -c core.quotepath=off diff --name-only --no-renames "$1...$2")
folders=$(cut -d/ -f1-2 <<<"$paths" | sort -u)
if [ "$(wc -l <<<"$folders")" != 1 ] || ! [[ $folders =~ ^submissions/[a-z0-9][a-z0-9_-]{0,39}$ ]]; then
  echo "a submission changes one folder, submissions/NAME, and nothing else; this one changes:" >&2
  echo "$paths" >&2
  exit 1
fi
echo "$folders"
[ -z "${GITHUB_OUTPUT:-}" ] || echo "folder=$folders" >>"$GITHUB_OUTPUT"
