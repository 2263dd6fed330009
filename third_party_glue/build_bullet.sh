#!/usr/bin/env bash
# Builds Bullet out of Debian's source package with other options than Debian's own, and installs it into a folder: set BULLET_ROOT to that for
# CMake.
#
# Usage: third_party_glue/build_bullet.sh folder [options for CMake ...]      e.g. ... build/bullet-mt -DBULLET2_MULTITHREADING=ON
#
# Does nothing where the folder holds a Bullet built with the same options.
set -euo pipefail

here=$( cd "$( dirname "${BASH_SOURCE[0]}" )" && pwd )
mkdir -p "${1:?"usage: third_party_glue/build_bullet.sh folder [options for CMake ...]"}"
folder=$( cd "$1" && pwd )
shift
if [ "$( cat "$folder/built" 2> /dev/null )" = "$*" ]; then
	exit 0
fi

"$here/install_packages.sh" g++ cmake ninja-build dpkg-dev
if [ -z "$( find "$folder" -mindepth 1 -maxdepth 1 -name 'bullet-*' -type d )" ]; then
	# The source packages of where the system's packages come from, with lists in a folder of our own: the system's stay as they are.
	release=$( . /etc/os-release && echo "$VERSION_CODENAME" )
	mkdir -p "$folder/lists/partial"
	apt-get indextargets --format 'deb-src $(REPO_URI) $(CODENAME) $(COMPONENT)' 'Created-By: Packages' "Codename: $release" | sort -u > "$folder/sources.list"
	apt=( apt-get -q -o Acquire::Retries=2 -o "Dir::Etc::SourceList=$folder/sources.list" -o Dir::Etc::SourceParts=- -o "Dir::State::Lists=$folder/lists" )
	( cd "$folder" && "${apt[@]}" update && "${apt[@]}" source bullet ) > "$folder/fetch.log" 2>&1 || { cat "$folder/fetch.log" >&2; exit 1; }
fi
source=$( find "$folder" -mindepth 1 -maxdepth 1 -name 'bullet-*' -type d )

options=( -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$folder/prefix" -DINSTALL_LIBS=ON -DCMAKE_POLICY_VERSION_MINIMUM=3.5 -DBUILD_SHARED_LIBS=ON )
for part in BULLET3 EXTRAS CPU_DEMOS BULLET2_DEMOS OPENGL3_DEMOS UNIT_TESTS PYBULLET CLSOCKET ENET; do
	options+=( "-DBUILD_$part=OFF" )
done
if command -v ccache > /dev/null 2>&1; then
	options+=( -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
fi
{
	cmake -S "$source" -B "$folder/build" -G Ninja "${options[@]}" -DUSE_GRAPHICAL_BENCHMARK=OFF "$@" &&
	cmake --build "$folder/build" --parallel "$( nproc )" --target BulletSoftBody BulletDynamics BulletCollision BulletInverseDynamics LinearMath &&
	cmake --install "$folder/build"
} > "$folder/build.log" 2>&1 || { tail -n 40 "$folder/build.log" >&2; exit 1; }
echo "$*" > "$folder/built"
