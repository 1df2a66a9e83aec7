# The rooms, docs/architecture.md: what may use what. Rooms of one layer do not know each other.

BEGIN {
    split("base 0 model 1 mechanics 2 divide 2 comm 2 meshing 3 layout 3 contact 4 step 5 " \
          "parallel 6 simulation 7 session 8 server 9 study 9 cli 10", words, " ")
    for (i = 1; i in words; i += 2) layer[words[i]] = words[i + 1]
    command_may["cli"] = command_may["study"] = 1
}

function folder_of(path) {
    sub(/\/.*/, "", path)
    return path
}

function may_use(folder, target) {
    if (folder == "cli") return target in command_may
    return target == folder || layer[target] < layer[folder]
}
