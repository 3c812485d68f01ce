# SPDX-License-Identifier: MIT
# Writes the files of a directory as C++: cmake -DFROM=page -DTO=page_files.cpp -P embed.cmake

set(type_html "text/html; charset=utf-8")
set(type_css "text/css; charset=utf-8")
set(type_js "text/javascript; charset=utf-8")
set(type_svg "image/svg+xml")

set(arrays "")
set(rows "")
file(GLOB names RELATIVE "${FROM}" "${FROM}/*.html" "${FROM}/*.css" "${FROM}/*.js" "${FROM}/*.svg")
list(SORT names)
set(number 0)
foreach(name IN LISTS names)
  file(READ "${FROM}/${name}" bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  cmake_path(GET name EXTENSION LAST_ONLY extension)
  string(SUBSTRING "${extension}" 1 -1 extension)
  set(path "/${name}")
  if(name STREQUAL "index.html")
    set(path "/")
  endif()
  string(APPEND arrays "constexpr unsigned char file_${number}[] = {${bytes}};\n")
  string(APPEND rows "    {\"${path}\", \"${type_${extension}}\", text_of(file_${number}, sizeof(file_${number}))},\n")
  math(EXPR number "${number} + 1")
endforeach()

file(
  WRITE "${TO}"
  "// Written by embed.cmake.
#include \"page_files.hpp\"

#include <array>
#include <cstddef>

namespace g4_tool {
namespace {

${arrays}
std::string_view text_of(const unsigned char* data, std::size_t size) noexcept {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace

std::span<const page_file> page_files() noexcept {
  static const std::array<page_file, ${number}> all{{
${rows}  }};
  return all;
}

}  // namespace g4_tool
"
)
