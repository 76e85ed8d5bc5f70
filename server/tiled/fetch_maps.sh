#!/usr/bin/env bash
# Fetches the sample maps of the Tiled editor into a folder, once: what Debian's package "tiled" ships as examples.
# The package is read, never installed. Exits 1 after a message when they cannot be had.
set -euo pipefail

readonly package=tiled

if (($# != 1)) || [[ $1 == -* ]]; then
    echo "usage: server/tiled/fetch_maps.sh FOLDER" >&2
    exit 2
fi
folder=$1

fail() {
    echo "fetch_maps.sh: $*" >&2
    exit 1
}

download() {
    apt-get download --quiet -o Acquire::Retries=1 -o Acquire::http::Timeout=20 \
        -o Acquire::https::Timeout=20 -o APT::Sandbox::User="$(id --user --name)" "$package" &>"$work/apt.log"
}

# A machine that never asked has no package lists
refresh_lists() {
    local as_root=()
    ((EUID == 0)) || as_root=(sudo --non-interactive)
    "${as_root[@]}" apt-get update --quiet &>"$work/apt.log"
}

[[ -s $folder/desert.tmx ]] && exit 0
for tool in apt-get dpkg-deb gunzip; do
    command -v "$tool" >/dev/null || fail "$tool is missing; the maps come out of a Debian package"
done
mkdir -p "$folder" || fail "$folder: cannot be made"
folder=$(cd "$folder" && pwd)
work=$(mktemp --directory)
trap 'rm -rf "$work"' EXIT

echo "Fetching the sample maps: Debian's package $package, 3 MB, read and not installed" >&2
cd "$work"
download || { refresh_lists && download; } || {
    tail -n 2 "$work/apt.log" >&2
    fail "$package could not be downloaded"
}
dpkg-deb --extract "$package"_*.deb package || fail "$package cannot be unpacked"
examples=package/usr/share/doc/tiled/examples
[[ -d $examples ]] || fail "$package holds no examples"
find "$examples" -name '*.gz' -exec gunzip {} +
# Last, since it says that all the others are there
mv "$examples/desert.tmx" "$work/desert.tmx"
cp -R "$examples/." "$folder" && cp "$work/desert.tmx" "$folder"
