#!/usr/bin/env bash
# run_guide.sh GUIDE.md FOLDER_OF_TRI: runs the ```sh blocks of a guide one after another in an empty folder.
set -euo pipefail

guide=$(realpath "$1")
export PATH="$(realpath "$2"):$PATH"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
awk '/^```sh$/ {inside = 1; next} /^```$/ {inside = 0} inside' "$guide" > commands.sh
if [ ! -s commands.sh ]; then echo "run_guide: $guide has no commands" >&2; exit 1; fi
bash -eux -o pipefail commands.sh
