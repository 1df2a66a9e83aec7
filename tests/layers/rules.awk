# Reads C files named on the command line as src/FOLDER/FILE, after rooms.awk; check.sh says what the
# rules are.

BEGIN {
    # What a library must not call. `study` works for the command and may print.
    ending = "exit _exit _Exit quick_exit abort"
    printing = "printf vprintf puts putchar perror putchar_unlocked"
    count = split(ending, words, " ")
    for (i = 1; i <= count; i++) ends_process[words[i]] = 1
    count = split(printing, words, " ")
    for (i = 1; i <= count; i++) prints[words[i]] = 1
    for (i = 1; i < ARGC; i++) known[substr(ARGV[i], 5)] = 1
}

FNR == 1 {
    file = substr(FILENAME, 5)
    folder = folder_of(file)
    in_comment = 0
    files++
    if (!(folder in layer)) complain("folder " folder " belongs to no layer; add it to the table")
}

{ code = without_comments($0) }

code ~ /^[ \t]*#[ \t]*include[ \t]*"/ {
    name = $0
    sub(/^[^"]*"/, "", name)
    sub(/".*$/, "", name)
    check_include(name)
    next
}

code ~ /^[ \t]*#[ \t]*include[ \t]*<(.*intrin|arm_neon|arm_sve)\.h>/ {
    if (file !~ /simd|kernel/)
        complain("vector intrinsics stay in simd.h and the kernels; use base/simd.h")
    next
}

folder != "cli" { check_calls(code) }

END {
    for (f in edges) visit(f)
    if (failed) exit 1
    print "layers: " files " files keep the rule"
}

function complain(what) {
    printf "src/%s:%d: %s\n", file, FNR, what
    failed = 1
}

function check_include(name, target) {
    if (name == "lariat.h" || name == "lariat_fit.h") return
    if (name ~ /^\.\.?\//) {
        complain("\"" name "\": write the path from src, so that the layer can be seen")
        return
    }
    if (name !~ /\//) name = folder "/" name
    target = folder_of(name)
    if (!(name in known)) {
        complain("\"" name "\" does not exist below src")
        return
    }
    if (!may_use(folder, target))
        complain(folder " may not include " target " (\"" name "\"); docs/architecture.md")
    edges[file] = edges[file] " " name
}

# Names followed by an opening parenthesis, and the standard streams by name. A name after `->`
# or `.` is a member, one inside a longer name is another function.
function check_calls(code, rest, word) {
    rest = code
    while (match(rest, /[A-Za-z_][A-Za-z_0-9]*[ \t]*\(/)) {
        word = substr(rest, RSTART, RLENGTH - 1)
        sub(/[ \t]+$/, "", word)
        if (!(RSTART > 1 && substr(rest, RSTART - 1, 1) ~ /[.>A-Za-z_0-9]/)) {
            if (word in ends_process)
                complain(word "() ends the program that embeds the library; return a lar_status")
            if (folder != "study" && word in prints)
                complain(word "() prints; the library never prints, return a message in lar_error")
        }
        rest = substr(rest, RSTART + RLENGTH)
    }
    if (folder != "study" && code ~ /(^|[^A-Za-z_0-9])(stdout|stderr)([^A-Za-z_0-9]|$)/)
        complain("stdout and stderr belong to the command; return a message in lar_error")
}

# The line with comments, strings and character constants blanked; in_comment carries over lines.
function without_comments(text, out, mark, at) {
    out = ""
    while (text != "") {
        if (in_comment) {
            at = index(text, "*/")
            if (!at) return out
            text = substr(text, at + 2)
            in_comment = 0
            continue
        }
        if (!match(text, /"|'|\/\*|\/\//)) return out text
        mark = substr(text, RSTART, RLENGTH)
        out = out substr(text, 1, RSTART - 1)
        text = substr(text, RSTART + RLENGTH)
        if (mark == "//") return out
        if (mark == "/*") {
            in_comment = 1
            out = out " "
            continue
        }
        out = out mark
        while (text != "" && substr(text, 1, 1) != mark)
            text = substr(text, substr(text, 1, 1) == "\\" ? 3 : 2)
        text = substr(text, 2)
        out = out mark
    }
    return out
}

# Depth first along the includes: meeting a file that is still open closes a circle.
function visit(f, targets, n, i) {
    if (state[f] == "done") return
    if (state[f] == "open") {
        printf "src/%s: is part of a circle of includes; move what both need into a third file\n", f
        failed = 1
        return
    }
    state[f] = "open"
    n = split(edges[f], targets, " ")
    for (i = 1; i <= n; i++) visit(targets[i])
    state[f] = "done"
}
