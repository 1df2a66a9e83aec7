# Reads the public headers, and then what `nm -A` says of the object files of a build; after
# rooms.awk. Every function of ours that a room calls is defined in a room that it may use; the
# command, what works for it and the viewers' server may call what is public, too.

FILENAME ~ /lariat(_sizes|_fit)?\.h$/ {
    if (match($0, /lar_[a-z0-9_]+\(/)) public[substr($0, RSTART, RLENGTH - 1)] = 1
    next
}

{
    object = $0
    sub(/\.o:.*/, "", object)
    sub(/^.*\.dir\//, "", object)
    room = folder_of(object)
    symbol = $NF
    if (symbol !~ /^lar_/ || !(room in layer)) next
    if ($(NF - 1) == "U") {
        calls[object, symbol] = 1
    } else if ($(NF - 1) ~ /^[A-Z]$/)
        home[symbol] = room
}

END {
    for (pair in calls) {
        split(pair, part, SUBSEP)
        room = folder_of(part[1])
        symbol = part[2]
        count++
        if ((room in only || room == "study") && symbol in public) continue
        if (symbol in home && !may_use(room, home[symbol])) {
            printf "src/%s: %s may not call %s of %s; docs/architecture.md\n", part[1], room,
                symbol, home[symbol]
            failed = 1
        }
    }
    if (failed) exit 1
    if (count < 1000 && !short) {
        print "layers: only " count + 0 " calls were found; are these the object files?"
        exit 1
    }
    print "layers: " count " calls keep the rule"
}
