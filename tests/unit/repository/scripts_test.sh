#!/usr/bin/env bash
# The scripts at the front door: they parse, refuse what they do not know before they do anything, and build
# targets that exist. That they install, build and serve is seen by running them.
source "$(dirname "$0")/support.sh"

while read -r script; do
    bash -n "$script" || wrong "$script: does not parse"
done < <(files '*.sh' '.ci/run')
for script in run.sh test.sh .ci/run docker/install.sh server/scenes/fetch_photos.sh \
    server/tiled/fetch_maps.sh; do
    [[ -x $script ]] || wrong "$script: is not executable"
done

# expect CODE TEXT COMMAND…: exits with CODE and says TEXT
expect() {
    local code=$1 text=$2 output status=0
    shift 2
    output=$("$@" 2>&1 </dev/null) || status=$?
    ((status == code)) || wrong "$*: exit code $status, not $code: $output"
    grep -qF -- "$text" <<<"$output" || wrong "$*: does not say \"$text\" but: $output"
}
folder=$(mktemp --directory)
trap 'rm -rf "$folder"' EXIT
expect 0 'usage: ./run.sh' ./run.sh --help
expect 2 'unknown option --bogus' ./run.sh --bogus
expect 2 'neither an image file' ./run.sh no-such-photo.jpg
expect 2 '--listen nowhere' ./run.sh --listen nowhere
expect 2 '65536' ./run.sh --listen 127.0.0.1:65536
expect 2 'one PHOTO or SCENE' ./run.sh pebbles coffee
expect 2 '--method quilt' ./run.sh --method quilt
expect 2 'a scene has a method of its own' ./run.sh pebbles --method wang
expect 1 'without scene.json' ./run.sh "$folder"
expect 1 'no display' env -u DISPLAY -u WAYLAND_DISPLAY ./run.sh --view
expect 0 'usage: docker/install.sh' docker/install.sh --help
expect 1 'unknown option' docker/install.sh --bogus
expect 1 'cannot be read' docker/install.sh "$folder/no-list"
expect 2 'usage:' server/scenes/fetch_photos.sh
expect 2 'usage:' server/tiled/fetch_maps.sh
printf 'bash\n\n# a comment\ncoreutils # and one here\n' >"$folder/list"
expect 0 '' docker/install.sh "$folder/list"

# A cache that is full asks nobody
mkdir "$folder/photos"
for photo in coffee stones maple-leaves leaf; do echo >"$folder/photos/$photo.jpg"; done
expect 0 '' env PATH=/nowhere "$BASH" server/scenes/fetch_photos.sh "$folder/photos"
mkdir "$folder/maps" && echo >"$folder/maps/desert.tmx"
expect 0 '' env PATH=/nowhere "$BASH" server/tiled/fetch_maps.sh "$folder/maps"

# Sample names that run.sh knows are those that there are
names=$("$tessera" samples --output "$folder/scenes" --only nothing 2>&1 | sed 's/.*there are //')
[[ $names == *pebbles* ]] || wrong "tessera samples: does not list the samples: $names"
for name in $names; do
    grep -qE "^    elif .*[\" ]${name}[\" ]" run.sh || wrong "run.sh: does not know the sample $name"
done

grep -qF './test.sh' .ci/run || wrong ".ci/run: does not call test.sh"
for target in tessera tessera_web tessera-view; do
    grep -qrE "add_(executable|custom_target)\($target\b" --include=CMakeLists.txt server client ||
        wrong "run.sh: target $target does not exist"
done
finish
