# SPDX-License-Identifier: MIT
# Completion for fish of each program, which lists what can follow; a line / stands for names of files.

function __g4lidar_words
    set -l words (commandline -opc)
    type -q $words[1]; or return
    set -l typed (commandline -ct)
    for line in ($words[1] --complete $words[2..] "$typed" 2>/dev/null)
        if test "$line" = /
            __fish_complete_path "$typed"
        else
            printf '%s\n' $line
        end
    end
end

for program in g4-dump g4-ros2 g4-serve
    complete -c $program -f -a '(__g4lidar_words)'
end
