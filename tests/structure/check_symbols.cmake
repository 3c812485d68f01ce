# SPDX-License-Identifier: MIT
# cmake -DNM=<nm> -DOBJECT=<file.o> -DPROCESSOR=<name> -P check_symbols.cmake
#
# Fails if <OBJECT>, in which the whole core is instantiated, needs more than memcpy, memmove, memset
# and memcmp: no heap, no exceptions, no printing, no libm, no atomics library.

cmake_minimum_required(VERSION 3.22)
execute_process(COMMAND "${NM}" -P "${OBJECT}" OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY)

set(allowed memcpy memmove memset memcmp)
set(helper "^$")
if(PROCESSOR MATCHES "^arm")
  # Operations without an instruction on the processor, from the library of the compiler:
  # conversions, sums, products and comparisons of float and double, division, 64 bits; the jump
  # tables of Thumb-1.
  string(
    JOIN "|" helpers
    "__aeabi_(d2f|f2d|[df]2u?[il]z|u?[il]2[df])"
    "__aeabi_[df](add|sub|rsub|mul|div|neg|cmp(eq|lt|le|ge|gt|un))"
    "__aeabi_c[df](cmpeq|cmple|rcmple)"
    "__aeabi_(u?idiv|u?idivmod|u?ldivmod|lmul|llsl|llsr|lasr|u?lcmp)"
    "__gnu_thumb1_case_[us][qhs]i"
  )
  set(helper "^(${helpers})$")
endif()

string(REGEX MATCHALL "[^\n]+" lines "${listing}")
set(defined 0)
set(needed)
set(faults)
foreach(line IN LISTS lines)
  if(line MATCHES "^[^ ]+ [TWV] ")
    math(EXPR defined "${defined} + 1")
  elseif(line MATCHES "^([^ ]+) [Uw]")
    set(symbol "${CMAKE_MATCH_1}")
    list(APPEND needed "${symbol}")
    if(NOT symbol IN_LIST allowed AND NOT symbol MATCHES "${helper}")
      list(APPEND faults "${symbol}")
    endif()
  endif()
endforeach()

if(faults)
  list(JOIN faults "\n  " text)
  message(FATAL_ERROR "The core needs these external symbols:\n  ${text}")
endif()
if(defined LESS 10)
  message(FATAL_ERROR "Only ${defined} functions in ${OBJECT}: is the core instantiated there?")
endif()
list(JOIN needed ", " text)
message("${defined} functions of the core; external symbols: ${text}")
