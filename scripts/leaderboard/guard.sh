#!/usr/bin/env bash
# guard.sh BASE HEAD: fails when the commits from BASE to HEAD change what only a keeper of the leaderboard may: the
# workflows, what a board takes, its verifications and refutations, and entries that are there. KEEPER=true says that a
# maintainer or the bot asks; then only a submission that brings other files along is refused. Reads the names of files.
source "$(dirname "$0")/common.sh"
[ $# = 2 ] || usage
git cat-file -e "$2^{commit}" 2>/dev/null || git fetch -q origin "$2"
changes=$(git -c core.quotepath=on diff --name-status --no-renames "$1...$2")
fail() {
  echo "$1:" >&2
  echo "$2" >&2
  exit 1
}
touched() { cut -f2- <<<"$changes" | grep -E "$1" || true; }
if [ -n "$(touched '^"?submissions/')" ]; then
  others=$(cut -f2- <<<"$changes" | grep -vE '^"?submissions/' || true)
  [ -z "$others" ] || fail "a submission changes its folder and nothing else; this one changes" "$others"
fi
[ "${KEEPER:-}" != true ] || exit 0
kept=$(touched '^"?(\.github/|leaderboard/(admission\.json|suites/|verifications/|refutations/))')
[ -z "$kept" ] || fail "only a keeper of the leaderboard changes these files" "$kept"
old=$(grep -vE '^A' <<<"$changes" | cut -f2- | grep -E '^"?leaderboard/entries/' || true)
[ -z "$old" ] || fail "an entry that is there is not changed or taken away" "$old"
