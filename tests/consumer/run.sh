#!/usr/bin/env bash
# Installs a built tree into a folder of its own, and builds and runs the consumer project against it: found with CMake and with
# pkg-config, with and without exceptions and run-time type information.
#
# Usage: tests/consumer/run.sh build-folder [--source]      --source: also with Pliant's sources inside the consumer's own build
set -euo pipefail

here=$( cd "$( dirname "${BASH_SOURCE[0]}" )" && pwd )
built=$( cd "${1:?"usage: tests/consumer/run.sh build-folder [--source]"}" && pwd )
work=$built/consumer
rm -rf "$work"
mkdir -p "$work"

cmake --install "$built" --prefix "$work/prefix" > "$work/install.log"
package=$( basename "$( find "$work/prefix" -name 'pliant*.pc' | head -n 1 )" .pc )
PKG_CONFIG_PATH=$( dirname "$( find "$work/prefix" -name "$package.pc" )" )${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH}
export PKG_CONFIG_PATH

consume() # name, then options for CMake
{
	local name=$1
	shift
	echo "--- consumer, $name"
	if ! cmake -S "$here" -B "$work/$name" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix" \
		-DCONSUMER_PACKAGE="$package" "$@" > "$work/$name.log" 2>&1 || ! cmake --build "$work/$name" >> "$work/$name.log" 2>&1; then
		cat "$work/$name.log"
		echo "consumer, $name: does not build" >&2
		exit 1
	fi
	cmake --build "$work/$name" --target run | grep -v '^\['
}

consume cmake
consume cmake-plain -DCONSUMER_PLAIN=ON
consume pkg-config -DCONSUMER_PKG_CONFIG=ON
consume pkg-config-plain -DCONSUMER_PKG_CONFIG=ON -DCONSUMER_PLAIN=ON
if [ "${2:-}" = --source ]; then
	consume source -DCONSUMER_SOURCE="$here/../.."
fi

# A program for the other precision of Bullet must not link: it would read our classes at wrong offsets.
own=bullet
other=bullet-float64
flags=-DBT_USE_DOUBLE_PRECISION
if [ "$package" = pliant-float64 ]; then
	own=bullet-float64
	other=bullet
	flags=
fi
if pkg-config --exists "$other"; then
	echo "--- consumer, of the other precision"
	prefix=$work/prefix
	# shellcheck disable=SC2046 # pkg-config's words are words
	if "${CXX:-c++}" -std=c++17 $flags -I"$prefix/include" $( pkg-config --cflags "$other" ) "$here/main.cpp" -o "$work/other" \
		-L"$( pkg-config --variable=libdir "$package" )" -l"$package" $( pkg-config --libs "$other" "$own" ) > "$work/other.log" 2>&1; then
		echo "consumer: a program of the other precision links, and should not" >&2
		exit 1
	fi
	if ! grep -q 'pliant::' "$work/other.log"; then
		cat "$work/other.log"
		echo "consumer: a program of the other precision fails for another reason than Pliant's names" >&2
		exit 1
	fi
	echo "does not link, as it should"
fi
