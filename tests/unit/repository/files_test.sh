#!/usr/bin/env bash
# What every folder and file has to keep: a README.md beside sources, no large file, no unfinished mark.
source "$(dirname "$0")/support.sh"

# Beside sources, or at most one folder above them inside tests, where a folder holds one kind of test
while read -r folder; do
    [[ -f $folder/README.md ]] || wrong "$folder: has sources and no README.md; say why it exists, what comes in, what goes out"
done < <(files 'server/*' 'client/*' 'shared/*' 'proto/*' | grep -E '\.(h|cpp|proto|js|mjs)$' | xargs -n1 dirname |
    sed -E 's|^(client/web)/.*|\1|' | sort -u)

while read -r file; do
    [[ -f $file ]] || continue
    size=$(stat --format %s "$file")
    ((size <= 1048576)) || wrong "$file: is $size bytes; at most 1 MiB: make it, or fetch it at set-up"
done < <(files '*')

# Spelled so that this file does not find itself
marks='\b(TO''DO|FIX''ME|XX''X|HA''CK)\b'
found=$(files '*' | grep -vE '(^LICENSE|package-lock\.json)$' | while read -r file; do [[ -f $file ]] && echo "$file"; done |
    xargs -d '\n' grep -nIE "$marks" /dev/null)
[[ -z $found ]] || wrong "unfinished marks:"$'\n'"$found"

# A path of one machine works on no other
found=$(files '*' | while read -r file; do [[ -f $file ]] && echo "$file"; done |
    xargs -d '\n' grep -nIE '(^|[^[:alnum:]_./}-])/(ro''ot|wo''rk)/' /dev/null)
[[ -z $found ]] || wrong "paths of one machine:"$'\n'"$found"

# What a text sends its reader to has to be there: links from its folder, sources by the end of their path
known=$'\n'$(files '*')$'\n'
while read -r text; do
    while read -r link; do
        [[ -e $(dirname "$text")/$link ]] || wrong "$text: links to $link, which is not there"
    done < <(grep -oP '(\]\(|^\[[^]]+\]: )\K[^)#\s]+' "$text" | grep -v '^https\?:')
    while read -r named; do
        [[ $known == *[/$'\n']"$named"$'\n'* ]] || wrong "$text: names $named, which is not there"
    done < <(grep -oP '`\K(\.\.?/)*[\w/.-]*\w\.(cpp|h|inc|proto|glsl|mjs|sh)(?=`)' "$text" | sed -E 's|^(\.\.?/)+||' |
        grep -v '^_' | sort -u)
done < <(files '*.md')

grep -q 'Apache License' LICENSE || wrong "LICENSE: is not the Apache License"
finish
