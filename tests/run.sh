#!/usr/bin/env bash
# Installs what the tests need, builds, and runs them.
#
# Usage: tests/run.sh [--full] [arguments for ctest ...]       e.g. tests/run.sh -R lattice
#
#   --full          the long tests too
#
# Environment: BUILD_DIR (default: build in the repository's root), JOBS (default: the number of processors), CMAKE_ARGS (more
# options for CMake), CXX (the compiler).
set -euo pipefail

root=$( cd "$( dirname "${BASH_SOURCE[0]}" )/.." && pwd )
. "$root/third_party_glue/build.sh"

labels=( --label-exclude '^full$' )
arguments=()
for word in "$@"; do
	case $word in
		--full) labels=() ;;
		-h | --help)
			sed -n '2,/^set /p' "${BASH_SOURCE[0]}" | sed -n 's/^# \{0,1\}//p'
			exit 0
			;;
		*) arguments+=( "$word" ) ;;
	esac
done

"$root/third_party_glue/install_packages.sh" "${build_packages[@]}" "${demo_packages[@]}" "${test_packages[@]}"
configure -DPLIANT_BUILD_DEMOS=ON -DPLIANT_BUILD_TESTS=ON -DPLIANT_BUILD_BENCH=ON
build all
cd "$BUILD_DIR"
ctest --parallel "$JOBS" --output-on-failure --no-tests=error "${labels[@]}" "${arguments[@]}"
