# shellcheck shell=bash disable=SC2034
# Sourced by the checks of this folder: $1 is the repository's root, $2 the program `tessera`.
cd "$1" || exit 1
tessera=$2
failures=0

# Says what is wrong; finish() then fails.
wrong() {
    echo "$*"
    failures=$((failures + 1))
}

finish() {
    echo "$failures problems"
    exit $((failures > 0))
}

# Files of the repository by pattern: as git knows them, or all of them where there is no git (an archive).
files() {
    if git rev-parse --git-dir &>/dev/null; then
        git ls-files --cached --others --exclude-standard -- "$@"
    else
        local pattern
        for pattern in "$@"; do
            find . -type f -path "./$pattern" -not -path './build/*' -not -path '*/node_modules/*' | sed 's|^\./||'
        done
    fi
}
