#!/bin/sh
# Man pages and completion are of the tables of options: every option of every command is in them.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1

expect 0 "$LARIAT" help --write share
silent
[ -e share/man/man1/lariat.1 ] || fail "there is no page of lariat"
for file in bash-completion/completions/lariat zsh/site-functions/_lariat \
    fish/vendor_completions.d/lariat.fish; do
    [ -s "share/$file" ] || fail "share/$file was not written"
done
for shell in bash zsh fish; do
    "$LARIAT" help --completion $shell >"$shell.script" || fail "no completion for $shell"
done
cmp -s bash.script share/bash-completion/completions/lariat || fail "two scripts for bash"

# Commands as --help lists them, and the benchmarks as theirs does.
"$LARIAT" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z-]*\) .*/\1/p' >commands
"$LARIAT" bench --help | sed -n '/^WHAT is/,/^and/s/^  \([a-z]*\) .*/bench \1/p' >>commands
[ "$(wc -l <commands)" -ge 20 ] || fail "only $(wc -l <commands) commands were found"
grep -qx doctor commands && grep -qx help commands || fail "the new commands are not listed"

while read -r command; do
    page=share/man/man1/lariat-$(echo "$command" | tr ' ' '-').1
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" $command --help
    wide=$(awk 'length($0) > 100' out)
    [ -z "$wide" ] || fail "$command --help has a line that no terminal shows whole: $wide"
    grep -o '^  --[a-z-]*' out | tr -d ' ' >options
    grep -q -x -e --help options || fail "$command --help lists no options"
    # shellcheck disable=SC2086
    "$LARIAT" help $command --man | cmp -s - "$page" || fail "$page is not what help --man prints"
    # What a reader of the page sees, as far as letters go.
    sed 's/\\-/-/g; s/\\f[BRI]//g' "$page" >seen
    grep -q "^lariat $command " seen || fail "$page has no synopsis"
    sed -n "/^    '$command')/,/^        ;;/p" bash.script >bash.part
    sed -n "/^    '$command')/,/^        ;;/p" zsh.script >zsh.part
    grep "seen_subcommand_from $(echo "$command" | sed 's/ /; and __fish_seen_subcommand_from /')'" \
        fish.script >fish.part
    while read -r option; do
        grep -q -e "^$option\( \|$\)" seen || fail "$page lacks $option"
        grep -q -e "$option[ ']" bash.part || fail "bash: $command lacks $option"
        grep -q -e "'[*]*$option\[" zsh.part || fail "zsh: $command lacks $option"
        [ "$option" = --help ] || grep -q -e "-l ${option#--} " fish.part ||
            fail "fish: $command lacks $option"
    done <options
    name=${command#bench }
    grep -q "[' ]$name[' ]" bash.script && grep -q "'$name:" zsh.script &&
        grep -q -e "-a $name " fish.script || fail "a script lacks the command $command"
done <commands

# Pages are read without a complaint.
if command -v man >/dev/null && command -v groff >/dev/null; then
    for page in share/man/man1/*.1; do
        LC_ALL=C.UTF-8 MANROFFSEQ='' man --warnings -E UTF-8 -l -Tutf8 -Z "$page" >roff 2>warnings
        [ ! -s warnings ] || fail "$page: $(cat warnings)"
    done
fi

# Bash and the others take the scripts, and bash completes by them.
if command -v bash >/dev/null; then
    cat >complete.bash <<'END'
source ./bash.script
# words WORD...: completions of the last
words() {
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    _lariat
    echo "${COMPREPLY[*]}"
}
words lariat doc
words lariat run --gri
words lariat run beam.yaml --element hex8-f
words lariat bench jit
words lariat bench kernel --sha
words lariat help verif
words lariat mesh --fix bo
words lariat run beam
END
    bash complete.bash >completed 2>&1
    cat >wanted <<'END'
doctor
--grid
hex8-full
jitter
--shape
verify
bottom

END
    cmp -s wanted completed || fail "bash completes $(tr '\n' '|' <completed)"
fi
for shell in zsh fish; do
    ! command -v $shell >/dev/null || $shell -n $shell.script || fail "$shell does not read its script"
done

# Wrong use.
expect 2 "$LARIAT" help --completion tcsh
complains 'bash, zsh, fish'
expect 2 "$LARIAT" help rnu
complains 'did you mean run'
expect 2 "$LARIAT" help bench kernl
complains 'there is no kernl of bench; lariat bench --help'
expect 2 "$LARIAT" help run --completion bash
expect 1 "$LARIAT" help --write /dev/null/share
complains 'cannot be written'
finish "help: every option of $(wc -l <commands) commands in pages and completion"
