#!/usr/bin/env bash
# link.sh MADE BOARD: puts the pages of trials that watch.sh made, MADE/ID/index.html, onto a board, and links them on its page.
# MADE comes from a machine that ran agents: only plain files are taken, of entries that the board has.
source "$(dirname "$0")/common.sh"
[ $# = 2 ] || usage
for entry in "$2"/entries/*.json; do
  id=$(basename "$entry" .json)
  page=$1/$id/index.html
  if [ -f "$page" ] && [ ! -L "$page" ]; then
    mkdir -p "$2/watch/$id"
    cp "$page" "$2/watch/$id/index.html"
  else
    echo "$id: no page" >&2
  fi
done
hthor leaderboard build --board "$2"
