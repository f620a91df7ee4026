#!/usr/bin/env bash
# pull_request.sh NAME: proposes what changed in leaderboard/ as a pull request. With DRY_RUN=1 it only says how.
source "$(dirname "$0")/common.sh"
[ $# = 1 ] || usage
[[ $1 =~ ^[a-z0-9][a-z0-9_-]{0,39}$ ]] || { echo "NAME must be a submission's, got '$1'" >&2; exit 2; }
do_it() { if [ -n "${DRY_RUN:-}" ]; then printf '%q ' "$@"; echo; else "$@"; fi; }
cd "$ROOT"
do_it git switch -c "leaderboard/$1"
do_it git add leaderboard
do_it git -c user.name="hthor leaderboard" -c user.email="leaderboard@users.noreply.github.com" commit -m "Leaderboard: $1"
do_it git push origin "leaderboard/$1"
do_it gh pr create --head "leaderboard/$1" --title "Leaderboard: $1" --body "An official evaluation of submissions/$1, verified by a drawn sample."
