# The rooms, docs/architecture.md: what may use what. Rooms of one layer do not know each other.

BEGIN {
    split("base 0 law 1 model 2 mechanics 3 divide 3 comm 3 meshing 4 layout 4 contact 5 step 6 " \
          "parallel 7 simulation 8 session 9 server 10 study 10 cli 11", words, " ")
    for (i = 1; i in words; i += 2) layer[words[i]] = words[i + 1]
    # Above the library's own layers: what is public, and no more than these.
    only["cli"] = " cli study base "
    only["server"] = " server base "
}

function folder_of(path) {
    sub(/\/.*/, "", path)
    return path
}

function may_use(folder, target) {
    if (folder in only) return index(only[folder], " " target " ") > 0
    return target == folder || layer[target] < layer[folder]
}
