# Reads C files named on the command line as src/FOLDER/FILE, after rooms.awk: how large rooms are,
# and how far their files know each other.
#
#   - at most 600 lines in a file (tables, *.inc, are as long as they are), at most 30 files at one
#     level of a room;
#   - within a room fewer than 5 arrows that go up. A source and its header are one; of all orders,
#     each above what it includes, the best leaves these. Without circles it leaves none, and where
#     two know each other one.

BEGIN {
    LINES = 600
    FILES = 30
    UP = 4
    for (i = 1; i < ARGC; i++) known[substr(ARGV[i], 5)] = 1
}

FNR == 1 {
    file = substr(FILENAME, 5)
    level = file
    sub(/\/[^\/]*$/, "", level)
    if (++files[level] == FILES + 1)
        complain("src/" level " has more than " FILES " files; give one subject a folder")
    unit = file
    sub(/\.[a-z]+$/, "", unit)
    room = folder_of(file)
    if (!((room, unit) in seen)) {
        seen[room, unit] = 1
        units[room] = units[room] " " unit
    }
}

FNR == LINES + 1 && FILENAME !~ /\.inc$/ {
    complain("src/" file " has more than " LINES " lines; split it by subject")
}

/^[ \t]*#[ \t]*include[ \t]*"/ {
    name = $0
    sub(/^[^"]*"/, "", name)
    sub(/".*$/, "", name)
    if (!(name in known) || folder_of(name) != room) next
    sub(/\.[a-z]+$/, "", name)
    if (name == unit || (unit, name) in arrow) next
    arrow[unit, name] = 1
    below[unit] = below[unit] " " name
}

END {
    for (room in units) {
        up = 0
        said = ""
        count = split(units[room], list, " ")
        for (i = 1; i <= count; i++)
            if (!(list[i] in number)) visit(list[i])
        if (up > UP)
            complain("src/" room ": " up " arrows go up, at least; what both need is a third file:" said)
        arrows += up
    }
    if (failed) exit 1
    print "layers: " arrows + 0 " arrows go up within rooms, no file and no level is too large"
}

function complain(what) {
    print what
    failed = 1
}

# Tarjan's search for what stands in circles together (SIAM Journal on Computing 1, 1972).
function visit(u, next_one, n, i, w) {
    number[u] = lowest[u] = ++numbers
    stack[++height] = u
    on_stack[u] = 1
    n = split(below[u], next_one, " ")
    for (i = 1; i <= n; i++) {
        w = next_one[i]
        if (!(w in number)) {
            visit(w)
            if (lowest[w] < lowest[u]) lowest[u] = lowest[w]
        } else if (on_stack[w] && number[w] < lowest[u])
            lowest[u] = number[w]
    }
    if (lowest[u] < number[u]) return
    n = 0
    do {
        w = stack[height--]
        on_stack[w] = 0
        circle[++n] = w
    } while (w != u)
    if (n > 1) up += fewest(n)
}

# The fewest arrows that go up among circle[1..n]. least[set]: with these below all others; sets are
# numbers, one more at a time.
function fewest(n, set, sets, i, j, bit, cost, sum) {
    for (i = 1; i <= n; i++) said = said " " circle[i]
    if (n > 12) return n
    sets = 2 ^ n
    split("", least)
    least[0] = 0
    for (set = 0; set < sets; set++)
        for (i = 1; i <= n; i++) {
            bit = 2 ^ (i - 1)
            if (int(set / bit) % 2) continue
            cost = least[set]
            for (j = 1; j <= n; j++)
                if (j != i && !(int(set / 2 ^ (j - 1)) % 2) && (circle[i], circle[j]) in arrow) cost++
            sum = set + bit
            if (!(sum in least) || cost < least[sum]) least[sum] = cost
        }
    return least[sets - 1]
}
