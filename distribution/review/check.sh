#!/usr/bin/env bash
# Checks or verifies all programs, with annotations for GitHub. Usage: FILES="*.csp" check.sh check|verify
set -euo pipefail

read -r -a patterns <<< "${FILES:-*.csp}"
mapfile -d '' -t programs < <(git ls-files -z -- "${patterns[@]}")
if [ "${#programs[@]}" -eq 0 ]; then
    echo "::error::no file of this repository matches ${patterns[*]}"
    exit 1
fi

case "$1" in
check)
    cspdiag check --format github -- "${programs[@]}"
    ;;
verify)
    # A file at a time, and all of them, even if one is not proved.
    status=0
    for program in "${programs[@]}"; do
        cspdiag verify --format github -- "$program" || status=$?
    done
    exit "$status"
    ;;
esac
