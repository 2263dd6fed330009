#!/usr/bin/env bash
# Builds the library without features (PLIANT_WITH_...=OFF) and runs a small program against it: the other features work, and missing ones are
# refused with a sentence.
#
# Usage: tests/options/run.sh folder [FEATURE ... | each]      e.g. tests/options/run.sh build/options LEVELS FRACTURE
#
#   no feature      without all of them
#   each            without each of them in turn, and then without all
#
# Environment: JOBS, OPTIMISE (default -O0: the test is whether it builds and refuses, not its speed).
set -euo pipefail

here=$( cd "$( dirname "${BASH_SOURCE[0]}" )" && pwd )
folder=${1:?"usage: tests/options/run.sh folder [FEATURE ... | each]"}
shift
all=( FRACTURE LEVELS PLASTICITY SURFACE FAR_LEVELS CLUSTERS SELF_COLLISION )

name_of() # FAR_LEVELS: FarLevels
{
	local word name=
	for word in ${1//_/ }; do
		name+=${word:0:1}$( tr '[:upper:]' '[:lower:]' <<< "${word:1}" )
	done
	echo "$name"
}

try_without() # name FEATURE ...
{
	local work=$folder/$1 feature options=() names=()
	shift
	for feature in "$@"; do
		options+=( "-DPLIANT_WITH_$feature=OFF" )
		names+=( "$( name_of "$feature" )" )
	done
	if command -v ccache > /dev/null 2>&1; then
		options+=( -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
	fi
	echo "--- without $*"
	mkdir -p "$work"
	if ! cmake -S "$here" -B "$work" -G Ninja -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS_DEBUG=${OPTIMISE:--O0}" "${options[@]}" > "$work/log" 2>&1 ||
		! cmake --build "$work" --parallel "${JOBS:-$( nproc )}" --target options >> "$work/log" 2>&1; then
		cat "$work/log"
		echo "options: does not build without $*" >&2
		exit 1
	fi
	"$work/options" "${names[@]}"
}

if [ "${1:-}" = each ]; then
	for one in "${all[@]}"; do
		try_without "$one" "$one"
	done
	set --
fi
if [ $# -gt 0 ]; then
	try_without "$( IFS=_; echo "$*" )" "$@"
else
	try_without nothing "${all[@]}"
fi
