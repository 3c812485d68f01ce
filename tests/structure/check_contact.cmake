# SPDX-License-Identifier: MIT
# The packages and documents name the maintainer and the addresses of packaging/contact, and no others at the
# placeholder's host. -DROOT=<the project>

include("${ROOT}/cmake/contact.cmake")

# names(<file> <text>...)
function(names file)
  file(READ "${ROOT}/${file}" content)
  foreach(text IN LISTS ARGN)
    string(FIND "${content}" "${text}" at)
    if(at EQUAL -1)
      message(SEND_ERROR "${file} lacks \"${text}\", which follows from packaging/contact")
    endif()
  endforeach()
endfunction()

foreach(key maintainer email homepage issues downloads security)
  set(${key} "${G4LIDAR_CONTACT_${key}}")
  if("${${key}}" STREQUAL "")
    message(SEND_ERROR "packaging/contact has no ${key}")
  endif()
endforeach()
names(debian/control "Maintainer: ${maintainer} <${email}>\n" "Homepage: ${homepage}\n")
names(debian/changelog " -- ${maintainer} <${email}>  ")
names(debian/copyright "Upstream-Contact: ${issues}\n")
names(
  package.xml "<maintainer email=\"${email}\">${maintainer}</maintainer>" "<url type=\"website\">${homepage}</url>"
  "<url type=\"bugtracker\">${issues}</url>"
)
names(
  pyproject.toml "maintainers = [{ name = \"${maintainer}\", email = \"${email}\" }]" "Homepage = \"${homepage}\"\n"
  "Issues = \"${issues}\"\n"
)
names(SUPPORT.md "${issues}" "${security}")
names(README.md "FROM=${downloads}/")

# An address of a placeholder that is none of these was forgotten when the others were replaced.
foreach(file debian/control debian/changelog debian/copyright package.xml pyproject.toml SUPPORT.md README.md)
  file(STRINGS "${ROOT}/${file}" lines REGEX "example\\.org")
  foreach(line IN LISTS lines)
    foreach(known downloads email issues homepage security)
      string(REPLACE "${${known}}" "" line "${line}")
    endforeach()
    if(line MATCHES "example\\.org")
      message(SEND_ERROR "${file}: an address that is not in packaging/contact: ${line}")
    endif()
  endforeach()
endforeach()
