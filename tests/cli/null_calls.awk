# Writes a table of all public calls from lariat.h and lariat_sizes.h, each with nothing but zeros:
# whatever is added there is in it.
#
#     awk -f null_calls.awk include/lariat.h include/lariat_sizes.h >null_calls.h

/^#/ { continued = /\\$/; next }
continued { continued = /\\$/; next }
{ text = text " " $0 }

END {
    while ((begin = index(text, "/*")) > 0)
        text = substr(text, 1, begin - 1) substr(text, begin + index(substr(text, begin), "*/") + 1)
    gsub(/\) *\{[^{}]*\}/, ");", text)     # of inline functions
    count = split(text, part, ";")
    for (i = 1; i <= count; i++) {
        if (part[i] ~ /typedef/ || !match(part[i], /lar_[a-z_0-9]+\(/)) continue
        name = substr(part[i], RSTART, RLENGTH - 1)
        if (name in seen) continue
        seen[name] = 1
        rest = substr(part[i], RSTART + RLENGTH)
        sub(/\)[^)]*$/, "", rest)          # attributes have none of their own
        gsub(/\([^()]*\)/, "", rest)       # const double (*u)[3]
        zeros = ""
        if (rest !~ /^ *void *$/) {
            zeros = "0"
            for (commas = gsub(/,/, ",", rest); commas > 0; commas--) zeros = zeros ", 0"
        }
        printf "static void call_%s(void) { (void)%s(%s); }\n", name, name, zeros
        names = names sprintf("    {\"%s\", call_%s},\n", name, name)
    }
    printf "static const struct { const char *name; void (*call)(void); } calls[] = {\n%s};\n", names
}
