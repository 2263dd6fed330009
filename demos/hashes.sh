#!/usr/bin/env bash
# Prints each scene's state hash, a line each: if the lines before and after a change are equal, it changed no bit of any scene.
#
# Usage: demos/hashes.sh [--frames N] [scene ...]      default: 60 frames of every scene, without pictures
#
# Environment: BUILD_DIR (default: build in the repository's root; pliant_demos must have been built there).
set -euo pipefail

root=$( cd "$( dirname "${BASH_SOURCE[0]}" )/.." && pwd )
demos=${BUILD_DIR:-$root/build}/demos/pliant_demos
frames=60
if [ "${1:-}" = --frames ]; then
	frames=$2
	shift 2
fi
scenes=( "$@" )
if (( ${#scenes[@]} == 0 )); then
	mapfile -t scenes < <( "$demos" --list | cut -d ' ' -f 1 )
fi
out=$( mktemp -d )
trap 'rm -r "$out"' EXIT
for scene in "${scenes[@]}"; do
	found=$( "$demos" --scene "$scene" --frames "$frames" --no-render --out "$out" --models "$root/models" )
	printf '%-14s %s\n' "$scene" "$( sed -n 's/.*state hash //p' <<< "$found" )"
done
