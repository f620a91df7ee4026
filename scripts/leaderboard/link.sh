#!/usr/bin/env bash
# link.sh MADE BOARD: puts the pages of trials that watch.sh made in MADE, a copy of the board, onto the board, and links them
# on its page. Of MADE, which a machine wrote that ran agents, only plain files of entries that the board has are taken.
source "$(dirname "$0")/common.sh"
[ $# = 2 ] || usage
for entry in "$2"/entries/*.json; do
  id=$(basename "$entry" .json)
  page=$1/watch/$id/index.html
  [ -f "$page" ] && [ ! -L "$page" ] || { echo "$id: no page" >&2; continue; }
  mkdir -p "$2/watch/$id"
  cp "$page" "$2/watch/$id/index.html"
done
hthor leaderboard build --board "$2"
