# SPDX-License-Identifier: MIT
# Sets G4LIDAR_CONTACT_maintainer, _email, _homepage, _issues, _downloads and _security: the lines of packaging/contact.

file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/../packaging/contact" lines REGEX "^[a-z]+=")
foreach(line IN LISTS lines)
  string(REGEX MATCH "^([a-z]+)=(.*)$" line "${line}")
  set(G4LIDAR_CONTACT_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}")
endforeach()
