# Completion of splatlas-player and splatlas-preprocess: their own help lists commands and options.
_splatlas() {
  local cur prev words cword command=()
  _init_completion -n =@ || return
  if ((cword > 1)) && [[ ${words[1]} != -* ]] && "$1" "${words[1]}" --help &>/dev/null; then command=("${words[1]}"); fi
  if [[ $cur == @* ]]; then  # @FILE: bash keeps the @ in the word
    cur=${cur#@}
    _filedir
    COMPREPLY=("${COMPREPLY[@]/#/@}")
    if [[ ${#COMPREPLY[@]} == 1 && -d ${COMPREPLY[0]#@} ]]; then
      COMPREPLY[0]+=/
      compopt -o nospace
    fi
    return
  fi
  if [[ $cur == *=* ]]; then  # --labels=FILE, NAME=FILE
    cur=${cur##*=}
    _filedir
    return
  fi
  if [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$1" "${command[@]}" --help | grep -oE '^ +(-[a-z],)?(--[a-z-]+,?)+' | grep -oE -- '--[a-z-]+')" -- "$cur")
    return
  fi
  _filedir
  if ((cword == 1)); then
    mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -W "$("$1" --help | sed -n '/^Subcommands:/,$s/^  \([a-z]*\) .*/\1/p')" -- "$cur")
  fi
}
complete -F _splatlas splatlas-player splatlas-preprocess
