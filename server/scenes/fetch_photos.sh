#!/usr/bin/env bash
# Fetches the photographs of the sample scenes into a folder, once: coffee.jpg, stones.jpg, maple-leaves.jpg
# and leaf.jpg, textures that Debian ships inside libreoffice-common. The package is read, never installed.
# Exits 1 after a message when they cannot be had.
set -euo pipefail

readonly photos=(coffee stones maple-leaves leaf)
readonly package=libreoffice-common

if (($# != 1)) || [[ $1 == -* ]]; then
    echo "usage: server/scenes/fetch_photos.sh FOLDER" >&2
    exit 2
fi
folder=$1

fail() {
    echo "fetch_photos.sh: $*" >&2
    exit 1
}

have_all() {
    local photo
    for photo in "${photos[@]}"; do
        [[ -s $folder/$photo.jpg ]] || return 1
    done
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

have_all && exit 0
for tool in apt-get dpkg-deb unzip; do
    command -v "$tool" >/dev/null || fail "$tool is missing; the photographs come out of a Debian package"
done
mkdir -p "$folder" || fail "$folder: cannot be made"
folder=$(cd "$folder" && pwd)
work=$(mktemp --directory)
trap 'rm -rf "$work"' EXIT

echo "Fetching the sample photographs: Debian's package $package, 24 MB, read and not installed" >&2
cd "$work"
download || { refresh_lists && download; } || {
    tail -n 2 "$work/apt.log" >&2
    fail "$package could not be downloaded"
}
dpkg-deb --fsys-tarfile "$package"_*.deb | tar --extract --to-stdout --wildcards '*/share/palette/standard.sob' \
    >palette.zip || fail "$package holds no share/palette/standard.sob"
for photo in "${photos[@]}"; do
    unzip -p palette.zip "Pictures/$photo.jpg" >"$folder/$photo.jpg.part" ||
        fail "standard.sob holds no Pictures/$photo.jpg"
    mv "$folder/$photo.jpg.part" "$folder/$photo.jpg"
done
