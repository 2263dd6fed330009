#!/usr/bin/env bash
# Installs what the demos need, builds them, and runs a scene. Writes frames (PNG), a film, a table and summary.json to out/<scene>/.
#
# Usage: demos/run.sh [scene] [--window] [options of pliant_demos ...]       e.g. demos/run.sh bunny_pile --frames 120
#
#   scene           default: bunny_pile; demos/run.sh --list lists all scenes
#   --window        show it in a window instead (needs a display)
#
# Without OpenGL the scene writes model files instead of pictures.
# Environment: OUT (default: out/<scene>), BUILD_DIR (default: build in the repository's root), JOBS, CMAKE_ARGS, CXX.
set -euo pipefail

root=$( cd "$( dirname "${BASH_SOURCE[0]}" )/.." && pwd )
. "$root/third_party_glue/build.sh"

scene=bunny_pile
case ${1:-} in
	-h | --help)
		sed -n '2,/^set /p' "${BASH_SOURCE[0]}" | sed -n 's/^# \{0,1\}//p'
		exit 0
		;;
	'' | -*) ;;
	*)
		scene=$1
		shift
		;;
esac

wishes=( --wish "${picture_packages[@]}" --wish "${film_packages[@]}" )
options=()
for word in "$@"; do
	if [ "$word" = --window ] && [ -z "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
		echo "demos: there is no display for --window (DISPLAY and WAYLAND_DISPLAY are not set), so the scene is drawn into files" >&2
		continue
	elif [ "$word" = --window ]; then
		wishes=( --wish "${picture_packages[@]}" --wish "${window_packages[@]}" )
	fi
	options+=( "$word" )
done

"$root/third_party_glue/install_packages.sh" "${build_packages[@]}" "${demo_packages[@]}" "${wishes[@]}"
"$root/demos/fetch_models.sh" "$root/models" || true # the scenes fall back on shapes made in code, and say so
configure -DPLIANT_BUILD_DEMOS=ON -DPLIANT_BUILD_TESTS=OFF -DPLIANT_BUILD_BENCH=OFF # their packages may not be there
build pliant_demos hello_soft_body
out=${OUT:-$root/out/$scene}
mkdir -p "$out"
exec "$BUILD_DIR/demos/pliant_demos" --scene "$scene" --out "$out" --models "$root/models" "${options[@]}"
