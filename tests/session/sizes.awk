# Writes lariat.h as an older or a newer program has it: structs that grow have one member less (not
# lar_image_info, whose last one is the image), or more.
#
#     awk -v way=older -f sizes.awk include/lariat.h >older/lariat.h

BEGIN {
    count = split("mesh_arrays model_info material_info tool_info tool_force mesh_quality " \
                  "meshing_options meshing_info region_info image_info options grid_choice " \
                  "simulation_info energy heavier contact_info checkpoint_info session_options " \
                  "session_info device_status session_status recording_info replay_report", grow, " ")
    for (i = 1; i <= count; i++) grows["lar_" grow[i]] = 1
}

{ text = text $0 "\n" }

END {
    while ((begin = index(text, "/*")) > 0)
        text = substr(text, 1, begin - 1) substr(text, begin + index(substr(text, begin), "*/") + 1)
    while (match(text, /typedef struct lar_[a-z_]+ \{[^}]*\}/)) {
        struct = substr(text, RSTART, RLENGTH)
        printf "%s", substr(text, 1, RSTART - 1)
        text = substr(text, RSTART + RLENGTH)
        name = struct
        sub(/typedef struct /, "", name)
        sub(/ .*/, "", name)
        sub(/\n.*/, "", name)
        if (name in grows && way == "newer") sub(/\}$/, "    double later[3];\n}", struct)
        if (name in grows && way == "older" && name != "lar_image_info") sub(/;[^;]*;[^;]*\}$/, ";\n}", struct)
        printf "%s", struct
        changed += name in grows
    }
    printf "%s", text
    if (changed != count) exit 1
}
