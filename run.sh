#!/usr/bin/env bash
# From a photograph to an endless texture in a browser: installs, builds, prepares, serves.
set -euo pipefail

usage() {
    cat <<'END'
usage: ./run.sh [PHOTO|SCENE] [--method METHOD] [--listen ADDR:PORT] [--view] [--prepare]

  PHOTO               an image file: prepared and served; the printed address opens it
  SCENE               a sample or a folder with a scene.json. Samples: pebbles,
                      pebbles-interchange, pebbles-wang (painted); coffee, stones,
                      maple-leaves, leaf (photographs); tiles, meadow-sand, leaves, autumn,
                      terrain, petals, grove (pattern blocks); message-board, fireflies,
                      windfall, flower-field, road (these move); constant, checker
                      Neither: all samples
  --method METHOD     how PHOTO is prepared: content_exchange unless given, interchange, wang
  --listen ADDR:PORT  where to serve, 127.0.0.1:7070 unless given; port 0 picks a free one
  --view              open the GL client too
  --prepare           do all but serve; the last line is the folder of prepared scenes,
                      which `tessera serve --scenes FOLDER` takes
END
}

say() { echo "run.sh: $*" >&2; }
fail() {
    say "$*"
    exit 1
}
misused() {
    say "$*; see ./run.sh --help"
    exit 2
}

target='' method=content_exchange listen=127.0.0.1:7070 view=false prepare_only=false
while (($# > 0)); do
    case $1 in
        --listen)
            (($# > 1)) || misused "--listen needs ADDR:PORT, such as 127.0.0.1:7070"
            listen=$2
            shift
            ;;
        --method)
            (($# > 1)) || misused "--method needs content_exchange, interchange or wang"
            method=$2
            shift
            ;;
        --method=*) method=${1#*=} ;;
        --listen=*) listen=${1#*=} ;;
        --view) view=true ;;
        --prepare) prepare_only=true ;;
        -h | --help)
            usage
            exit 0
            ;;
        -*) misused "unknown option $1" ;;
        *)
            [[ -z $target ]] || misused "one PHOTO or SCENE at a time: $target or $1"
            [[ -n $1 ]] || misused "PHOTO or SCENE is empty"
            target=$1
            ;;
    esac
    shift
done
if [[ $method != content_exchange && $method != interchange && $method != wang ]]; then
    misused "--method $method: content_exchange, interchange or wang"
fi
if ! [[ $listen =~ ^.+:[0-9]{1,5}$ ]] || ((10#${listen##*:} > 65535)); then
    misused "--listen $listen: ADDR:PORT, such as 127.0.0.1:7070"
fi
if $view && [[ -z ${DISPLAY:-}${WAYLAND_DISPLAY:-} ]]; then
    fail "--view opens a window, and there is no display here; set DISPLAY, or leave --view out"
fi

# What was asked for: photo, folder (a scene's), sample or nothing
kind=samples
if [[ -n $target ]]; then
    if [[ -f $target ]]; then
        [[ -r $target ]] || fail "$target: cannot be read"
        kind=photo
        target=$(realpath "$target")
    elif [[ -d $target ]]; then
        [[ -f $target/scene.json ]] || fail "$target: is a folder without scene.json; name a scene's folder"
        kind=folder
        target=$(realpath "$target")
    elif [[ " pebbles pebbles-interchange pebbles-wang coffee stones maple-leaves leaf tiles meadow-sand leaves autumn terrain petals grove message-board fireflies windfall flower-field road constant checker " == *" $target "* ]]; then
        kind=sample
    else
        misused "$target: neither an image file, nor a scene's folder, nor a sample's name"
    fi
fi

if [[ $method != content_exchange && $kind != photo ]]; then
    misused "--method $method: is for a PHOTO; a scene has a method of its own"
fi

cd "$(dirname "$(realpath "$0")")"
readonly build=build/release scenes=$PWD/build/scenes
readonly photos=${XDG_CACHE_HOME:-$HOME/.cache}/tessera/photos
readonly tessera=$build/bin/tessera

# Before minutes of building, since it is cheap to ask
port_is_taken() {
    local address=${listen%:*}
    address=${address#[}
    [[ ${listen##*:} != 0 ]] && (exec 3<>"/dev/tcp/${address%]}/${listen##*:}") 2>/dev/null
}
if ! $prepare_only && port_is_taken; then
    fail "$listen is in use; stop what serves there, or choose another: --listen 127.0.0.1:0 picks a free one"
fi

docker/install.sh --without-tests

say "building; the first time takes some minutes"
targets=(tessera tessera_web)
$view && targets+=(tessera-view)
log=$(mktemp)
trap 'rm -f "$log"' EXIT
cmake --preset release >"$log" 2>&1 || {
    cat "$log" >&2
    fail "the build could not be set up; cmake's words stand above"
}
cmake --build --preset release --target "${targets[@]}" >&2 || fail "the build failed; its words stand above"

# What is prepared, and which scene the printed address opens
mkdir -p "$scenes"
served=$scenes opened=''
fetch_photos() {
    server/scenes/fetch_photos.sh "$photos" || say "going on without the sample photographs"
}
case $kind in
    photo)
        opened=$("$tessera" scene "$target" --method "$method" --output "$scenes") || exit 1
        ;;
    folder)
        "$tessera" check "$target" >&2 || exit 1
        served=$target
        opened=$(basename "$target")
        ;;
    sample)
        case $target in
            coffee | stones | maple-leaves | leaf) fetch_photos ;;
        esac
        "$tessera" samples --output "$scenes" --photos "$photos" --only "$target" || exit 1
        opened=$target
        ;;
    samples)
        fetch_photos
        "$tessera" samples --output "$scenes" --photos "$photos" ||
            say "not every sample could be prepared; going on with the others"
        ;;
esac
if $prepare_only; then
    echo "$served"
    exit 0
fi

# The server prints one line when it is ready
rm -f "$log"
exec {ready}< <(exec "$tessera" serve --scenes "$served" --listen "$listen")
server=$! viewer=''
trap 'kill -TERM "$server" $viewer 2>/dev/null || true' INT TERM HUP EXIT
if ! read -r line <&"$ready"; then
    fail "the server did not start; its words stand above"
fi
echo "$line"
address=${line##* }
address=${address/0.0.0.0/127.0.0.1}
address=${address/\[::\]/\[::1\]}
echo "Open $address/${opened:+#$opened}"
echo "Ctrl-C stops."
if $view; then
    "$build/bin/tessera-view" "$address" "${opened:-pebbles}" &
    viewer=$!
fi

# A signal ends the first wait early; the second sees the server out
status=0
wait "$server" || status=$?
if ((status > 128)); then
    wait "$server" 2>/dev/null || true
    exit 0
fi
((status == 0)) || say "the server ended with exit code $status; its words stand above"
exit "$status"
