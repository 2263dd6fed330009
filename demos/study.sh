#!/usr/bin/env bash
# Installs what the study needs, builds it, and runs it: error against run time for the user's mesh. Writes to out/study_<mesh>/:
# study.html (a self-contained page), study.csv, study.json and runs.jsonl. A run that was stopped continues where it was.
#
# Usage: demos/study.sh [options of pliant_study ...]       e.g. demos/study.sh --mesh rabbit.obj --scene all --budget 1ms
#
#   --help          lists all options
#   --full          everything, for hours, into docs/study/ (demos/study_full.sh)
#
# Environment: BUILD_DIR (default: build in the repository's root), JOBS, CMAKE_ARGS, CXX.
set -euo pipefail

root=$( cd "$( dirname "${BASH_SOURCE[0]}" )/.." && pwd )
. "$root/third_party_glue/build.sh"

"$root/third_party_glue/install_packages.sh" "${build_packages[@]}" "${demo_packages[@]}" --wish "${plot_packages[@]}" --wish "${picture_packages[@]}"
configure -DPLIANT_BUILD_DEMOS=ON -DPLIANT_BUILD_TESTS=OFF -DPLIANT_BUILD_BENCH=OFF # their packages may not be there
build pliant_study
if [ "${1:-}" = --full ]; then
	exec "$root/demos/study_full.sh"
fi
exec "$BUILD_DIR/demos/study/pliant_study" "$@"
