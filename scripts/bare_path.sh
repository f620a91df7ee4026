#!/usr/bin/env bash
# bare_path.sh FOLDER: fills the folder with links to all commands of the PATH but bubblewrap, browsers and Node, for a
# try of hthor on a machine that has none of them: PATH=FOLDER make test.
set -euo pipefail
folder=${1:?bare_path.sh FOLDER}
mkdir -p "$folder"
IFS=:
for place in $PATH; do
  for file in "$place"/*; do
    name=${file##*/}
    case $name in
      bwrap | chromium* | google-chrome* | chrome | firefox* | node | nodejs | npm | npx) ;;
      *) [ -x "$file" ] && [ ! -d "$file" ] && [ ! -e "$folder/$name" ] && ln -s "$file" "$folder/$name" ;;
    esac || true
  done
done
