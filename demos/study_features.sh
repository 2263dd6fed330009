#!/usr/bin/env bash
# The cost of each feature: instructions (counted by valgrind's callgrind, the same in every run), time, memory and binary size; off, idle and working.
# Also the cost of a feature that is off: the whole library compared with one built without it (PLIANT_WITH_...=OFF).
#
# Usage: demos/study_features.sh [--out folder] [--steps N]      [out/features, 20 game steps]
#
# Environment: BUILD_DIR (default: build in the repository's root), JOBS, CMAKE_ARGS, CXX.
set -euo pipefail

root=$( cd "$( dirname "${BASH_SOURCE[0]}" )/.." && pwd )
. "$root/third_party_glue/build.sh"
out=out/features
steps=20
while [ $# -gt 0 ]; do
	case $1 in
		--out) out=$2; shift 2 ;;
		--steps) steps=$2; shift 2 ;;
		*) sed -n '2,/^set /p' "${BASH_SOURCE[0]}" | sed -n 's/^# \{0,1\}//p'; exit 0 ;;
	esac
done
features=( FRACTURE LEVELS PLASTICITY SURFACE FAR_LEVELS CLUSTERS SELF_COLLISION )
readonly features plain=0 without_skin=1 # numbers of the cases to compare with

"$root/third_party_glue/install_packages.sh" "${build_packages[@]}" "${demo_packages[@]}" valgrind binutils
configure -DPLIANT_BUILD_DEMOS=ON -DPLIANT_BUILD_TESTS=OFF -DPLIANT_BUILD_BENCH=OFF
build pliant_study
mkdir -p "$out"
"$BUILD_DIR/demos/study/pliant_study" features --out "$out" > "$out/features.log"

make_one() # name option ...: the program with a library built so
{
	local work=$BUILD_DIR/features/$1
	shift
	local options=( "$@" )
	if command -v ccache > /dev/null 2>&1; then
		options+=( -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
	fi
	cmake -S "$root/tests/options" -B "$work" -G Ninja -DCMAKE_BUILD_TYPE=Release "${options[@]}" > "$work.log" 2>&1 &&
		cmake --build "$work" --parallel "$JOBS" --target feature_cost >> "$work.log" 2>&1 || { cat "$work.log"; return 1; }
	strip -o "$work/stripped" "$work/feature_cost"
}

count() # name case: instructions a game step
{
	local work=$BUILD_DIR/features/$1
	valgrind --tool=callgrind --collect-atstart=no --toggle-collect=countedSteps --callgrind-out-file=/dev/null "$work/feature_cost" "$2" "$steps" 2>&1 |
		sed -n "s/.*Collected : //p" | awk -v n="$steps" '{ printf "%.0f", $1 / n }'
}

bytes_of() # name: code and data of the stripped program
{
	size "$BUILD_DIR/features/$1/stripped" | awk 'NR == 2 { print $1 + $2 }'
}

mkdir -p "$BUILD_DIR/features"
make_one whole
all=()
for feature in "${features[@]}"; do
	make_one "$feature" "-DPLIANT_WITH_$feature=OFF"
	all+=( "-DPLIANT_WITH_$feature=OFF" )
done
make_one nothing "${all[@]}"

page=$out/features.md
{
	echo "| feature | | instructions a step | time | memory |"
	echo "|---|---|---|---|---|"
} > "$page"
base=$( count whole "$plain" )
"$BUILD_DIR/features/whole/feature_cost" | while IFS='|' read -r number feature state; do
	instructions=$( count whole "$number" )
	awk -F';' -v row=$(( number + 2 )) -v n="$instructions" -v base="$base" -v feature="$feature" -v state="$state" \
		'NR == row { printf "| %s | %s | %.2f M, x %.3f | %.0f us, x %.2f | %.0f kB, x %.2f |\n", feature, state, n / 1e6, n / base, $4, $7, $5 / 1024, $8 }' \
		"$out/features.csv" >> "$page"
done

whole_bytes=$( bytes_of whole )
{
	echo
	echo "| library without | instructions of a plain body a step | over the whole library's | program, kB | saved, kB |"
	echo "|---|---|---|---|---|"
	for name in whole "${features[@]}" nothing; do
		compared=$plain
		if [ "$name" = SURFACE ] || [ "$name" = nothing ]; then
			compared=$without_skin
		fi
		there=$( count whole "$compared" )
		here=$( count "$name" "$compared" )
		awk -v name="$name" -v here="$here" -v there="$there" -v bytes="$( bytes_of "$name" )" -v whole="$whole_bytes" 'BEGIN {
			sub( /^whole$/, "nothing: the whole library", name ); sub( /^nothing$/, "all of these", name )
			printf "| %s | %.0f | %+.3f %% | %.0f | %.0f |\n", name, here, 100 * ( here / there - 1 ), bytes / 1024, ( whole - bytes ) / 1024 }'
	done
} >> "$page"
cat "$page"
echo
echo "$page, features.csv"
