#!/usr/bin/env bash
# The whole study, into docs/study/: error against run time of three meshes in all scenes, material benchmarks, stability, scale, and the
# cost of each feature, with the name of the processor. Takes hours; a run that was stopped continues when it is called again.
#
# Usage: demos/study.sh --full          (which builds first, and then calls this)
#
# Environment: OUT (default: out/full), PARTS (default: materials features scale study stability), and those of demos/study.sh.
set -euo pipefail

root=$( cd "$( dirname "${BASH_SOURCE[0]}" )/.." && pwd )
. "$root/third_party_glue/build.sh"
program=$BUILD_DIR/demos/study/pliant_study
out=${OUT:-$root/out/full}
docs=$root/docs/study
parts=${PARTS:-materials features scale study stability}
readonly meshes=( bunny bar cube ) features=(--out "$out/features")
mkdir -p "$out" "$docs"

# Each part writes a log; a part with a log is not run again. The exit code is 3 if a result is out of its bounds, which the log shows.
part() # name command ...
{
	local name=$1 code=0
	shift
	if [ -s "$out/$name.log" ]; then
		return
	fi
	echo "=== $name: $*" >&2
	"$@" > "$out/$name.partial" || code=$?
	if [ $code -ne 0 ] && [ $code -ne 3 ]; then
		echo "=== $name ended with $code" >&2
		exit $code
	fi
	mv "$out/$name.partial" "$out/$name.log"
}

for name in $parts; do
	case $name in
		materials) part materials "$program" materials --out "$out/materials" ;;
		features) part features "$root/demos/study_features.sh" "${features[@]}" ;;
		scale) part scale "$program" scale --out "$out/scale" ;;
		stability) part stability "$program" stability --out "$out/stability" ;;
		study)
			for mesh in "${meshes[@]}"; do
				part "study_$mesh" "$program" --shape "$mesh" --scene all --budget 1ms --out "$out/study_$mesh"
			done
			;;
		*)
			echo "study_full: no part $name" >&2
			exit 2
			;;
	esac
done

# Small files go into the docs: tables and logs. Pages and pictures stay in $out.
for file in materials/materials.csv stability/stability.csv scale/scale.csv features/features.csv; do
	[ ! -f "$out/$file" ] || cp "$out/$file" "$docs/"
done
for mesh in "${meshes[@]}"; do
	[ ! -f "$out/study_$mesh/study.csv" ] || cp "$out/study_$mesh/study.csv" "$docs/study_$mesh.csv"
done
{
	echo "# A full run of the study"
	echo
	echo "\`./demos/study.sh --full\` on $( sed -n 's/^model name[^:]*: //p' /proc/cpuinfo 2> /dev/null | head -n 1 ), $( nproc ) processors, revision $( git -C "$root" rev-parse --short HEAD 2> /dev/null || echo unknown )."
	echo "The numbers: the .csv files beside this one. What they mean: [../study.md](../study.md). What features cost: [features.md](features.md)."
	for log in "$out"/*.log; do
		echo
		echo "## $( basename "$log" .log )"
		echo
		echo '```'
		grep -v -e '^$' -e ' runs, ' -e "$out" "$log" | cut -c 1-200
		echo '```'
	done
} > "$docs/README.md"
echo "$docs/README.md"
