# shellcheck shell=bash disable=SC2034 # the lists are for the scripts that read this file
# What ./tests/run.sh and ./demos/run.sh share: the packages by name, and how to configure and build. Read it with `.`; `root` is the
# repository's folder.

build_packages=( g++ cmake ninja-build pkg-config libbullet-dev libeigen3-dev )
demo_packages=( libassimp-dev zlib1g-dev libcli11-dev nlohmann-json3-dev )
test_packages=( libgtest-dev libgmock-dev libbenchmark-dev )
picture_packages=( libepoxy-dev libegl-dev libgl-dev libgl1-mesa-dri libglm-dev libstb-dev )
window_packages=( libglfw3-dev libimgui-dev )
film_packages=( ffmpeg )
plot_packages=( gnuplot-nox )

BUILD_DIR=${BUILD_DIR:-$root/build}
JOBS=${JOBS:-$( nproc )}

configure() # options for CMake ...
{
	local options=( -DCMAKE_BUILD_TYPE="${BUILD_TYPE:-Release}" -DPLIANT_SHARED_TOO=ON -DPLIANT_PRECOMPILE=ON )
	if command -v ccache > /dev/null 2>&1; then
		options+=( -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
	fi
	# shellcheck disable=SC2206 # CMAKE_ARGS holds several words
	options+=( ${CMAKE_ARGS:-} )
	mkdir -p "$BUILD_DIR"
	if ! cmake -S "$root" -B "$BUILD_DIR" -G Ninja "${options[@]}" "$@" > "$BUILD_DIR/configure.log" 2>&1; then
		cat "$BUILD_DIR/configure.log"
		echo "configure: failed; the lines above say why, and are kept in $BUILD_DIR/configure.log" >&2
		return 1
	fi
	grep 'Pliant:' "$BUILD_DIR/configure.log" || true
}

build() # targets ...
{
	cmake --build "$BUILD_DIR" --parallel "$JOBS" --target "$@"
}
