#!/usr/bin/env bash
# Installs those packages of a list that are missing; asks for nothing, and needs no network when none is.
set -euo pipefail

usage() {
    cat <<'END'
usage: docker/install.sh [--without-tests] [LIST]

  LIST              a file of Debian packages, one a line; docker/packages.txt unless named
  --without-tests   leave out what stands below the list's line "# tests only"
END
}

fail() {
    echo "install.sh: $*" >&2
    exit 1
}

list=$(dirname "$0")/packages.txt
last_line='$'
while (($# > 0)); do
    case $1 in
        --without-tests) last_line='/^# tests only$/' ;;
        -h | --help)
            usage
            exit 0
            ;;
        -*) fail "unknown option $1; see --help" ;;
        *) list=$1 ;;
    esac
    shift
done
[[ -r $list ]] || fail "$list: cannot be read; name a list of packages"

is_installed() {
    # Node from elsewhere is as good, and Debian's would conflict with it
    case $1 in
        nodejs) command -v node >/dev/null && return ;;
        npm) command -v npm >/dev/null && return ;;
    esac
    [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

missing=()
while read -r package; do
    is_installed "$package" || missing+=("$package")
done < <(sed -n "1,${last_line}p" "$list" | sed 's/#.*//; s/[[:space:]]//g; /^$/d')
((${#missing[@]} > 0)) || exit 0

command -v apt-get >/dev/null ||
    fail "no apt-get here; install what corresponds to these Debian 12 packages: ${missing[*]}"
as_root=()
if ((EUID != 0)); then
    command -v sudo >/dev/null ||
        fail "installing needs root; run as root, or install sudo, or ask for: apt-get install ${missing[*]}"
    as_root=(sudo)
fi

echo "Installing ${#missing[@]} Debian packages: ${missing[*]}" >&2
install() {
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install --yes --quiet --no-install-recommends "${missing[@]}" >&2
}
"${as_root[@]}" apt-get update --quiet >&2 || echo "install.sh: the package lists could not all be refreshed" >&2
install || fail "apt-get could not install: ${missing[*]}; its own words stand above"
