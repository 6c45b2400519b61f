# Completion of raya in bash: commands, options and values as `raya COMMAND --help-all` lists them. Install it as
# share/bash-completion/completions/raya; in zsh: autoload -U bashcompinit && bashcompinit && source raya.bash
_raya() {
    local raya=${COMP_WORDS[0]/#\~/$HOME} word=${COMP_WORDS[COMP_CWORD]} at=$((COMP_CWORD - 1)) option='' value='' names=() commands='' options=''
    local name help line
    # bash also splits words at "=": --machine=spa is three words.
    if [[ $word == = ]]; then word=''; elif [[ ${COMP_WORDS[at]} == = ]]; then at=$((at - 1)); fi
    [[ ${COMP_WORDS[at]} != -* ]] || option=${COMP_WORDS[at]}
    for name in "" "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do  # the help of the last command in the line
        [[ -z $name || " $commands " == *" $name "* ]] || continue
        [[ -z $name ]] || names+=("$name")
        help=$(COLUMNS=120 "$raya" "${names[@]}" --help-all 2>/dev/null) || return
        commands=$(sed -n '/^\(Commands\|Studies\):/,/^$/s/^  \([a-z][a-z0-9-]*\).*/\1/p' <<<"$help" | tr '\n' ' ')
    done
    while IFS= read -r line; do  # "  -o, --output IMAGE   Image to write"
        [[ $line =~ ^\ \ (-[a-z],\ )?(--?[a-z-]+)(\ ([^ ]+))?(\ \ .*)?$ ]] || continue
        options+=" ${BASH_REMATCH[2]}"
        [[ -z $option || ", ${BASH_REMATCH[1]}${BASH_REMATCH[2]}," != *" $option,"* ]] || value=${BASH_REMATCH[4]}
    done <<<"$help"
    if [[ -z $value && $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
    elif [[ $value == *'|'* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(sed 's/\[[^]]*\]//g; s/|/ /g' <<<"$value")" -- "$word")
    elif [[ -z $value && -n $commands ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$word")
    elif [[ $value =~ ^(|FILE|DIR|SCENE|IMAGE) ]]; then
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
    fi
}
complete -o filenames -F _raya raya
