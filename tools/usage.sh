# shellcheck shell=bash
# Sourced by the scripts beside it, before they change folder. The comment that a script begins with is its help.

print_help() {
    sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"
}

# help_if_asked WORD...: prints the help and ends the script, where a word asks for that.
help_if_asked() {
    case " $* " in
    *" --help "* | *" -h "*)
        print_help
        exit 0
        ;;
    esac
}

# refuse_word WORD: ends the script, which does not know the word.
refuse_word() {
    echo "${0##*/}: '$1' is not known; see tools/${0##*/} --help" >&2
    exit 2
}
