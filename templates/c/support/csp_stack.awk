# SPDX-License-Identifier: 0BSD
#
# The deepest stack of each function of the interface, and the frame of each function, from the call graphs that gcc writes (-fcallgraph-info=su):
#
#     awk -v package=jiwy -f csp_stack.awk *.ci
#
# A call through a pointer may reach any function that is internal to a file and that no other function calls by its name: a step of a process, a device
# function. Messages of faults are reached from csp_describe_message only. Steps call nothing through pointers but device functions, which return before the next step. Ends with status 1 if
# functions call each other in a cycle, or one has an array of variable length.

function quoted(line, key,    start) {
    start = index(line, key ": \"")
    if (start == 0) {
        return ""
    }
    line = substr(line, start + length(key) + 3)
    return substr(line, 1, index(line, "\"") - 1)
}

function plain(name) {
    sub(/^.*:/, "", name)
    return name
}

/^node:/ {
    name = quoted($0, "title")
    if (match($0, /[0-9]+ bytes/)) {
        frame[name] = substr($0, RSTART, RLENGTH - 6) + 0
    }
    if (index($0, " bytes (dynamic)")) {
        print "no bound: " plain(name) " has an array of variable length, or calls alloca"
        unbounded = 1
    }
}

/^edge:/ {
    source = quoted($0, "sourcename")
    target = quoted($0, "targetname")
    calls[source] = calls[source] "\n" target
    called[target] = 1
}

# Notes that a call from `key` reaches this depth below it.
function reaches(key, below, callee) {
    if (below > deepest_below[key]) {
        deepest_below[key] = below
        deepest_callee[key] = callee
    }
}

# The bytes of a function and of all that it calls; `steps`: whether calls through pointers are followed.
function depth(name, steps,    key, count, list, place, other, describes) {
    key = name SUBSEP steps
    if (key in known) {
        return known[key]
    }
    if (key in entered) {
        print "recursion: " plain(name) " calls itself"
        recursive = 1
        return 0
    }
    entered[key] = 1
    count = split(calls[name], list, "\n")
    for (place = 1; place <= count; place++) {
        if (list[place] == "__indirect_call") {
            describes = name ~ /csp_describe_message/
            if (steps) {
                for (other in frame) {
                    if (describes ? (other ~ /describe_/) : (other ~ /:/ && !(other in called) && other !~ /describe_/)) {
                        reaches(key, depth(other, 0), other SUBSEP 0)
                    }
                }
            }
        } else if (list[place] != "") {
            reaches(key, depth(list[place], steps), list[place] SUBSEP steps)
        }
    }
    delete entered[key]
    known[key] = frame[name] + deepest_below[key]
    return known[key]
}

END {
    worst = ""
    for (name in frame) {
        depth(name, 1)
        if (name ~ "^" package "_" && name !~ "^" package "_csp_" && name !~ /:/ && !(name in called)) {
            print sprintf("%6d bytes  %s", known[name SUBSEP 1], name) | "sort -rn"
            if (name !~ /_describe$/ && (worst == "" || known[name SUBSEP 1] > known[worst])) {
                worst = name SUBSEP 1
            }
        }
    }
    close("sort -rn")
    if (worst != "") {
        print "the deepest but for descriptions, function by function:"
    }
    while (worst != "") {
        split(worst, part, SUBSEP)
        print sprintf("%6d bytes  %s", frame[part[1]], plain(part[1]))
        worst = deepest_callee[worst]
    }
    print "the frame of each function:"
    for (name in frame) {
        print sprintf("%6d bytes  %s", frame[name], plain(name)) | "sort -k1,1nr -k3"
    }
    close("sort -k1,1nr -k3")
    print (recursive ? "there is recursion" : "no function calls itself, directly or through others")
    exit recursive || unbounded
}
