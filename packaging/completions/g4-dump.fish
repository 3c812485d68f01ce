# SPDX-License-Identifier: MIT
# Completion of g4-dump for fish. g4-dump lists what can follow; a line / stands for names of files.

function __g4_dump_words
    set -l words (commandline -opc)
    set -l typed (commandline -ct)
    for line in ($words[1] --complete $words[2..] "$typed" 2>/dev/null)
        if test "$line" = /
            __fish_complete_path "$typed"
        else
            printf '%s\n' $line
        end
    end
end

complete -c g4-dump -f -a '(__g4_dump_words)'
