# SPDX-License-Identifier: MIT
# cmake -DFROM=<directory> -DTO=<file.hpp> -P embed_transcripts.cmake
#
# Writes a header that contains every transcript of a directory as text, for systems without files.

cmake_minimum_required(VERSION 3.22)
file(GLOB transcripts "${FROM}/*.txt")
list(SORT transcripts)
if(NOT transcripts)
  message(FATAL_ERROR "No transcripts in ${FROM}")
endif()

set(entries)
foreach(transcript IN LISTS transcripts)
  cmake_path(GET transcript STEM name)
  set(literals)
  file(READ "${transcript}" text)
  string(REGEX REPLACE "#[^\n]*" "" text "${text}")
  if(text MATCHES "[][\"\\;]") # characters that neither the format nor CMake lists support
    message(FATAL_ERROR "${name}.txt: a quote, backslash, semicolon or bracket outside of comments")
  endif()
  string(REPLACE "\n" ";" lines "${text}")
  foreach(line IN LISTS lines)
    if(line MATCHES "^[<>=]")
      string(APPEND literals "\n     \"${line}\\n\"")
    elseif(line MATCHES "^ *$")
      string(APPEND literals "\n     \"\\n\"") # keeps the numbers of the lines
    else()
      message(FATAL_ERROR "${name}.txt: neither <, >, = nor a comment: ${line}")
    endif()
  endforeach()
  string(APPEND entries "    {\"${name}\",${literals}},\n")
endforeach()

list(LENGTH transcripts count)
file(
  CONFIGURE OUTPUT "${TO}"
  CONTENT
    "// SPDX-License-Identifier: MIT
// Written by embed_transcripts.cmake: the transcripts of tests/transcripts, without their comments.
#pragma once

#include <array>
#include <string_view>

namespace self_test {

struct embedded_transcript {
  std::string_view name;
  std::string_view text;
};

inline constexpr std::array<embedded_transcript, @count@> transcripts{{
@entries@}};

}  // namespace self_test
"
  @ONLY
)
