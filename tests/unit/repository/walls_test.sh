#!/usr/bin/env bash
# Includes point at the ground: server and client never meet, shared stands on nothing but itself, nothing
# stands on the tests. In includes and in CMake's link lines.
source "$(dirname "$0")/support.sh"

# no_include FOLDER PATTERN REASON: no file under FOLDER includes what matches PATTERN
no_include() {
    local found
    found=$(files "$1/*" | grep -E '\.(h|cpp|cc|inc)$' | xargs -r grep -nE "^[[:space:]]*#[[:space:]]*include[[:space:]]*[<\"]$2" /dev/null)
    [[ -z $found ]] || wrong "$3:"$'\n'"$found"
}

# no_link FOLDER PATTERN REASON: no CMakeLists.txt under FOLDER names a target that matches PATTERN
no_link() {
    local found
    found=$(files "$1/*" | grep -E 'CMakeLists\.txt$' | xargs -r grep -nE "$2" /dev/null)
    [[ -z $found ]] || wrong "$3:"$'\n'"$found"
}

no_include server 'client/' "server includes client"
no_include client 'server/' "client includes server"
no_include shared '(server|client)/' "shared includes a side"
for folder in server client shared proto; do
    no_include "$folder" 'tests/' "$folder includes tests"
done
found=$(files 'shared/*' | grep -E '\.(h|cpp)$' | grep -v '^shared/wire/' | xargs -r grep -nE '#[[:space:]]*include[[:space:]]*"proto/' /dev/null)
[[ -z $found ]] || wrong "only shared/wire includes proto within shared:"$'\n'"$found"

no_link server 'tessera::client' "server links client"
no_link client 'tessera::server' "client links server"
no_link shared 'tessera::(server|client)' "shared links a side"

# The check itself sees what it should see
[[ $(files 'server/*' | grep -cE '\.(h|cpp)$') -gt 20 ]] || wrong "found hardly any source of the server: the check is blind"
finish
