#!/usr/bin/env bash
# What the image, the compose file and the package lists name exists: there may be no Docker engine to try.
source "$(dirname "$0")/support.sh"

packages_of() { sed 's/#.*//; s/[[:space:]]//g; /^$/d' "$1"; }

# Packages: each once, and known to apt where it has lists
for list in docker/packages.txt docker/packages-runtime.txt; do
    [[ -s $list ]] || wrong "$list: is missing or empty"
    twice=$(packages_of "$list" | sort | uniq -d)
    [[ -z $twice ]] || wrong "$list: named twice: $twice"
done
mapfile -t packages < <(packages_of docker/packages.txt; packages_of docker/packages-runtime.txt)
if command -v apt-cache >/dev/null && apt-cache policy libc6-dev 2>/dev/null | grep -qE "Candidate: [0-9]"; then
    known=$(apt-cache policy "${packages[@]}" 2>/dev/null | grep -E -B2 'Candidate: [0-9]' | sed -n 's/^\([^ ]*\):$/\1/p')
    for package in "${packages[@]}"; do
        grep -qxF "$package" <<<"$known" || wrong "$package: apt knows no such package"
    done
else
    echo "no package lists of apt here: names of packages are not checked"
fi

# Every file that the Dockerfile copies from the repository, and every program it runs out of it
while read -r path; do
    [[ -e $path ]] || wrong "docker/Dockerfile: copies $path, which does not exist"
done < <(sed -n 's/^COPY \([^-].*\) [^ ]*$/\1/p' docker/Dockerfile | tr ' ' '\n')
while read -r path; do
    [[ -x ${path#/source/} ]] || wrong "docker/Dockerfile: runs $path, which is no program"
done < <(grep -oE '/source/docker/[a-z_.]+\.sh' docker/Dockerfile | sort -u | grep -v txt)
while read -r path; do
    case $path in
        /source/build/release/bin/* | /source/build/release/share/* | /scenes) ;;
        /source/*) [[ -e ${path#/source/} ]] || wrong "docker/Dockerfile: copies $path, which does not exist" ;;
        *) wrong "docker/Dockerfile: copies $path, which no step makes" ;;
    esac
done < <(sed -n 's/^COPY --from=build \(--[a-z]*=[^ ]* \)\?\([^ ]*\) .*/\2/p' docker/Dockerfile)
while read -r ignored; do
    grep -E '^COPY [^-]' docker/Dockerfile | grep -qw -- "$ignored" && wrong ".dockerignore: hides $ignored, which the Dockerfile copies"
done < <(grep -vE '[*]' .dockerignore)
grep -q '^USER tessera' docker/Dockerfile || wrong "docker/Dockerfile: the server would run as root"
grep -q '^HEALTHCHECK .*/healthz' docker/Dockerfile || wrong "docker/Dockerfile: has no health check"

# CMake presets and targets
while read -r preset; do
    grep -qF "\"name\": \"$preset\"" CMakePresets.json || wrong "docker/Dockerfile: preset $preset does not exist"
done < <(grep -oE 'preset [a-z]+' docker/Dockerfile | cut -d' ' -f2 | sort -u)
while read -r target; do
    grep -qrE "add_(executable|custom_target)\($target\b" --include=CMakeLists.txt server client ||
        wrong "docker/Dockerfile: target $target does not exist"
done < <(sed -n 's/.*--target \([a-z_ ]*[a-z_]\).*/\1/p' docker/Dockerfile | tr " " "\n")

# Subcommands and options of `tessera`, in the Dockerfile and the README
check_options() {  # FILE SUBCOMMAND OPTION…
    local file=$1 command=$2 help option
    shift 2
    help=$("$tessera" "$command" --help 2>&1) || wrong "$file: tessera $command does not exist"
    for option in "$@"; do
        grep -qE -- "$option([ ,]|\$)" <<<"$help" || wrong "$file: tessera $command has no $option"
    done
}
while read -r line; do
    read -ra words <<<"$line"
    mapfile -t options < <(printf '%s\n' "${words[@]:1}" | grep -E '^--')
    check_options "docker/Dockerfile" "${words[0]}" "${options[@]}"
done < <(
    sed -n 's/.*bin\/tessera \(samples .*\)/\1/p' docker/Dockerfile
    sed -n 's/^CMD \[\(.*\)\]/\1/p' docker/Dockerfile | tr -d '",'
)
check_options docker/README.md scene --output

# Libraries that the program is linked to come from packages of the runtime list, or of every Debian
if command -v ldd >/dev/null && command -v dpkg-query >/dev/null && ! ldd "$tessera" | grep -qE 'lib(a|t)san'; then
    while read -r library; do
        path=$(ldd "$tessera" | awk -v name="$library" '$1 == name {print $3}')
        package=$({ dpkg-query --search "$path" || dpkg-query --search "$(realpath "$path")"; } 2>/dev/null | head -n 1 | cut -d: -f1)
        case $package in
            libc6 | libgcc-s1 | libstdc++6 | libfmt9) continue ;;  # of every Debian; libfmt9 with libspdlog1.10
            '') wrong "$library: belongs to no package" ;;
            *) packages_of docker/packages-runtime.txt | grep -qxF "$package" || wrong "docker/packages-runtime.txt: misses $package, which has $library" ;;
        esac
    done < <(objdump -p "$tessera" | awk '$1 == "NEEDED" {print $2}' | grep -v '^ld-linux')
fi

# The compose file
dockerfile=$(sed -n 's/^ *dockerfile: *//p' docker/compose.yaml)
context=$(sed -n 's/^ *context: *//p' docker/compose.yaml)
[[ -f docker/$context/$dockerfile ]] || wrong "docker/compose.yaml: $context/$dockerfile does not exist"
port=$(sed -n 's/^EXPOSE //p' docker/Dockerfile)
grep -qF ":$port\"" docker/compose.yaml || wrong "docker/compose.yaml: does not publish port $port of the image"
grep -qF "0.0.0.0:$port" docker/Dockerfile || wrong "docker/Dockerfile: the server does not listen on the exposed port $port"
volume=$(sed -n 's/^VOLUME //p' docker/Dockerfile)
grep -qF ":$volume" docker/compose.yaml || wrong "docker/compose.yaml: does not mount $volume"
finish
