#!/bin/sh
# Fetches the models of Debian's package libcgal-demo (145 meshes, 23 MB) into a folder, without installing it and without root.
#
# Usage: demos/fetch_models.sh [folder]          (default: models/ in the repository's root, which git ignores)
#
# The files are not part of this repository: several are scans whose makers ask for credit (the bunny, the dragon and the armadillo
# come from the Stanford 3D Scanning Repository). Without them the demos use shapes made in code, and report that.
# The exit code is 0 if the models exist, and 1 with a message if they cannot be downloaded.
set -eu

here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
models=${1:-$here/../models}
wanted=$models/data/meshes/bunny00.off
scan=$models/data/images/liver.inr # 25 MB, packed in the package

# Stored next to the compressed file, so that the demos need no library for it.
unpack_scan()
{
	if [ -s "$scan.gz" ] && [ ! -s "$scan" ]; then
		gzip -dc "$scan.gz" > "$scan.part" && mv "$scan.part" "$scan"
	fi
}

if [ -s "$wanted" ]; then
	unpack_scan || echo "models: $scan.gz cannot be unpacked; liver_cut uses a shape made in code" >&2
	echo "models: already in $models"
	exit 0
fi
for tool in apt-get dpkg-deb tar; do
	if ! command -v "$tool" > /dev/null 2>&1; then
		echo "models: $tool is missing, so libcgal-demo cannot be fetched; the demos use shapes made in code instead" >&2
		exit 1
	fi
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM

# apt switches to a user who must be able to write here.
chmod 755 "$work"
if ! ( cd "$work" && timeout 180 apt-get -q download libcgal-demo ) > "$work/log" 2>&1; then
	echo "models: 'apt-get download libcgal-demo' did not work: $( grep -m1 '^E:' "$work/log" || tail -n 1 "$work/log" )" >&2
	echo "models: the demos use shapes made in code instead" >&2
	exit 1
fi

dpkg-deb -x "$work"/libcgal-demo_*.deb "$work/package"
archive=$work/package/usr/share/doc/libcgal-dev/data.tar.gz
if [ ! -s "$archive" ]; then
	echo "models: libcgal-demo no longer holds usr/share/doc/libcgal-dev/data.tar.gz; the demos use shapes made in code instead" >&2
	exit 1
fi
mkdir -p "$models"
tar -xzf "$archive" -C "$models" --no-same-owner
cp "$work/package/usr/share/doc/libcgal-demo/copyright" "$models/copyright" 2> /dev/null || true

if [ ! -s "$wanted" ]; then
	echo "models: data.tar.gz was unpacked into $models, but $wanted is not in it" >&2
	exit 1
fi
unpack_scan || echo "models: $scan.gz cannot be unpacked; liver_cut uses a shape made in code" >&2
echo "models: $( find "$models/data/meshes" -type f | wc -l ) meshes in $models/data/meshes"
