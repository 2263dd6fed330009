#!/usr/bin/env bash
# Installs the Debian packages that are missing out of a list; both commands call it, and anyone may.
#
# Usage: third_party_glue/install_packages.sh package ... [--wish package ...] [--wish package ...]
#
# What stands before the first --wish is needed: when it cannot be had, this says what to do and ends with 1. Each --wish begins a group
# that we can do without: when it cannot be had, a note says so. Touches no network when nothing is missing.
set -euo pipefail

readonly least_cmake=3.25

# Tools count as there when they can be called, wherever they come from; libraries when their package is installed.
is_there() # package
{
	case $1 in
		g++) command -v "${CXX:-c++}" || command -v g++ || command -v clang++ ;;
		cmake) command -v cmake && [ "$( printf '%s\n' "$least_cmake" "$( cmake --version | sed -n '1s/[^0-9]*//p' )" | sort -V | head -n 1 )" = "$least_cmake" ] ;;
		ninja-build) command -v ninja ;;
		pkg-config | ffmpeg) command -v "$1" ;;
		*) [ "$( dpkg-query -W -f '${db:Status-Status}\n' "$1" 2> /dev/null | sort -u )" = installed ] ;;
	esac > /dev/null 2>&1
}

missing_of() # package ...
{
	local package
	for package in "$@"; do
		is_there "$package" || echo "$package"
	done
}

log=$( mktemp )
trap 'rm -f "$log"' EXIT

# How to become root: nothing to do, or sudo where it asks for no password or there is someone to ask.
as_root=()
may_install=yes
if [ "$( id -u )" != 0 ]; then
	if command -v sudo > /dev/null 2>&1 && { sudo -n true 2> /dev/null || [ -t 0 ]; }; then
		as_root=( sudo )
	else
		may_install=no
	fi
fi

apt() # arguments for apt-get; its words go to the log
{
	"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300 -o Acquire::Retries=2 \
		-o Acquire::http::Timeout=30 -o Acquire::https::Timeout=30 "$@" >> "$log" 2>&1 < /dev/null
}

lists_are_fresh=no
install() # package ...; false when it did not work, and then `why` says why
{
	why=""
	if [ "$may_install" = no ]; then
		why="this needs root, or sudo"
		return 1
	fi
	echo "packages: installing $*"
	if [ "$lists_are_fresh" = no ]; then
		apt update || true # the lists that are there may do
		lists_are_fresh=yes
	fi
	apt install --no-install-recommends "$@" && return 0
	why=$( grep -m 1 '^E:' "$log" || tail -n 1 "$log" )
	return 1
}

# --- the groups: needed, then wished for --------------------------------------------------------------------------------------------
needed=()
while [ $# -gt 0 ] && [ "$1" != --wish ]; do
	needed+=( "$1" )
	shift
done

if ! command -v dpkg-query > /dev/null 2>&1 || ! command -v apt-get > /dev/null 2>&1; then
	echo "packages: this is no Debian system, so nothing was checked or installed. What is needed, by Debian's names: ${needed[*]}" >&2
	exit 0 # CMake finds out what is there
fi

mapfile -t missing < <( missing_of "${needed[@]}" )
if [ ${#missing[@]} -gt 0 ] && ! install "${missing[@]}"; then
	echo "packages: these are missing and could not be installed: ${missing[*]}" >&2
	echo "packages: because: $why" >&2
	echo "packages: as root, with a network, this does it:  apt-get update && apt-get install --no-install-recommends ${missing[*]}" >&2
	exit 1
fi

while [ $# -gt 0 ]; do
	shift # --wish
	group=()
	while [ $# -gt 0 ] && [ "$1" != --wish ]; do
		group+=( "$1" )
		shift
	done
	mapfile -t missing < <( missing_of "${group[@]}" )
	if [ ${#missing[@]} -gt 0 ] && ! install "${missing[@]}"; then
		echo "packages: going on without ${missing[*]} ($why)"
	fi
done
