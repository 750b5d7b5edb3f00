#!/usr/bin/env bash
# Shows what a pull request changes in the diagrams: in the summary of the job, and in a comment.
#
# BASE is the commit with which to compare, NUMBER the pull request, COMMENT whether to comment ("true"), and
# PICTURES_BRANCH the beginning of the name of the branch for pictures, or empty.
set -euo pipefail

folder="$RUNNER_TEMP/diagram-changes"
mkdir -p "$folder"
mark="<!-- changes of diagrams, by cspdiag -->"

git cat-file -e "$BASE^{commit}" 2> /dev/null || git fetch --quiet --depth=1 origin "$BASE"

# 2: some of a version cannot be read, which the review says, and the check reports.
status=0
cspdiag diff --from "$BASE" --exit-zero --format markdown --scheme light -o "$folder/pictures/" --pictures png \
    > "$folder/changes.md" || status=$?
if [ "$status" -ne 0 ] && [ "$status" -ne 2 ]; then
    exit "$status"
fi
if [ ! -s "$folder/changes.md" ] && [ "$status" -ne 0 ]; then
    echo "::error::the programs could not be compared"
    exit "$status"
fi

# The comment of an earlier run is brought up to date; with "anew" there is one even if there was none.
comment() {
    local earlier
    earlier=$(gh api --paginate "repos/$GITHUB_REPOSITORY/issues/$NUMBER/comments" \
        --jq "[.[] | select(.body | startswith(\"$mark\"))][0].id // empty" | sed -n 1p) || earlier=""
    if [ -n "$earlier" ]; then
        gh api --silent --method PATCH "repos/$GITHUB_REPOSITORY/issues/comments/$earlier" -F "body=@$folder/comment.md"
    elif [ "$1" = "anew" ]; then
        gh pr comment "$NUMBER" --repo "$GITHUB_REPOSITORY" --body-file "$folder/comment.md"
    fi || echo "::warning::no comment: the job needs the permission pull-requests: write; the changes are in its summary"
}

heading() {
    echo "$mark"
    echo "## Changes of the diagrams"
    echo
}

if [ ! -s "$folder/changes.md" ]; then
    echo "no program has changed"
    if [ "$COMMENT" = "true" ]; then
        # An earlier state of the pull request may have had changes.
        { heading; echo "No diagram differs any more."; } > "$folder/comment.md"
        comment "if there is one"
    fi
    exit 0
fi

without_pictures() {
    sed '/^!\[What changed in the diagrams of /d' "$folder/changes.md"
}

# A branch of its own for each pull request holds the pictures of its last state.
push_pictures() {
    local branch="$PICTURES_BRANCH/$NUMBER" index commit
    index="$folder/index"
    rm -f "$index"
    GIT_INDEX_FILE="$index" git --work-tree="$folder/pictures" add --force --all .
    commit=$(git -c user.name=cspdiag -c user.email=cspdiag@users.noreply.github.com \
        commit-tree -m "Pictures of pull request $NUMBER" "$(GIT_INDEX_FILE="$index" git write-tree)")
    git push --quiet --force origin "$commit:refs/heads/$branch" || return 1
    echo "$GITHUB_SERVER_URL/$GITHUB_REPOSITORY/raw/$commit"
}

{
    heading
    if [ -n "${PICTURES_BRANCH:-}" ] && [ -d "$folder/pictures" ]; then
        if address=$(push_pictures); then
            # The name of the folder is not compared: as an address it is encoded.
            sed "s|^\(!\[What changed in the diagrams of .*\](\).*/diagram-changes/pictures/|\1$address/|" \
                "$folder/changes.md"
        else
            echo "::warning::the pictures could not be pushed: the job needs the permission contents: write" >&2
            without_pictures
        fi
    else
        without_pictures
    fi
} > "$folder/comment.md"

cat "$folder/comment.md" >> "$GITHUB_STEP_SUMMARY"
if [ "$COMMENT" = "true" ]; then
    comment anew
fi
